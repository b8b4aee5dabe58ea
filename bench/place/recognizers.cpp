#include "bench/place/recognizers.hpp"

#include <algorithm>
#include <cmath>

#include "bench/place/place_search.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/features/hamming.hpp"
#include "kinloop/loop/recognition/recognize_place.hpp"

namespace kinloop {
namespace {

BowVector bow_of(const Place& place, const Vocabulary& vocabulary) {
  return vocabulary.bow_of(vocabulary.quantize(place.features.descriptors).words);
}

/// Landmarks of one image in its camera frame.
LocalMap view_of(const Features& features, const PinholeCamera& camera) {
  LocalMap view;
  view.features = std::make_shared<const Features>(features);
  view.descriptors = cv::Mat(0, kOrbBytes, CV_8UC1);
  for (uint32_t i = 0; i < features.size(); ++i) {
    if (features.depths_m[i] <= 0) continue;
    const Eigen::Vector3d p = camera.unproject(features.pixels[i].cast<double>(), features.depths_m[i]);
    view.ids.push_back({i});
    view.p_reference.push_back(p);
    view.viewing_directions.push_back(-p.normalized());
    view.observed_distances_m.push_back(p.norm());
    view.observed_levels.push_back(features.levels[i]);
    view.descriptors.push_back(features.descriptors.row(static_cast<int>(i)));
  }
  return view;
}

/// Returns whether the relative pose found within a scene agrees with ground truth.
bool is_right(const Place& query, const Place& found, const SE3& T_found_query) {
  constexpr double kMax_m = 0.2, kMax_rad = 0.17;
  const SE3 error = (found.T_scene_camera->inverse() * *query.T_scene_camera).inverse() * T_found_query;
  return error.translation.norm() <= kMax_m && Eigen::AngleAxisd(error.rotation).angle() <= kMax_rad;
}

}  // namespace

Recognition recognize(std::span<const Place> places,
                      const std::function<std::vector<PlaceCandidate>(size_t query)>& ask) {
  Recognition recognition;
  size_t asked = 0;
  const Stopwatch watch;
  for (size_t query = 0; query < places.size(); ++query) {
    if (!places[query].T_scene_camera) continue;
    ++asked;
    const auto found = ask(query);
    if (found.empty()) continue;
    recognition.answers.push_back({query, found[0].keyframe.value, found[0].score});
  }
  recognition.query_ms = 1000 * watch.cpu_s() / static_cast<double>(asked);
  return recognition;
}

Recognition by_words(std::span<const Place> places, const Vocabulary& vocabulary) {
  PlaceIndex index;
  for (size_t i = 0; i < places.size(); ++i) index.add(id_of(i), bow_of(places[i], vocabulary));
  return recognize(places, [&](size_t query) {
    return index.query(index.bow_of(id_of(query)), 1,
                       [&](KeyframeId id) { return is_admissible(places[query], places[id.value]); });
  });
}

Recognition by_geometric_verification(std::span<const Place> places, const Vocabulary& vocabulary) {
  PlaceSearch search;
  std::vector<ImageWords> words;
  for (size_t i = 0; i < places.size(); ++i) {
    const auto quantized = vocabulary.quantize(places[i].features.descriptors);
    words.push_back(image_words(places[i].features, quantized.words, vocabulary));
    search.add(id_of(i), vocabulary.bow_of(quantized.words), words.back());
  }
  return recognize(places, [&](size_t query) {
    return search.query(search.index().bow_of(id_of(query)), words[query], 1,
                        [&](KeyframeId id) { return is_admissible(places[query], places[id.value]); });
  });
}

Detection detect(std::span<const Place> places, const Vocabulary& vocabulary, const PinholeCamera& camera) {
  const Sensor sensor{camera};
  const PlaceOptions options;
  PlaceIndex index;
  for (size_t i = 0; i < places.size(); ++i) index.add(id_of(i), bow_of(places[i], vocabulary));
  Detection detection;
  for (size_t query = 0; query < places.size(); ++query) {
    const Place& place = places[query];
    if (!place.T_scene_camera) continue;
    const auto allowed = [&](KeyframeId id) { return is_admissible(place, places[id.value]); };
    Frame frame;
    frame.features = std::make_shared<const Features>(place.features);
    for (const auto& candidate : index.query(index.bow_of(id_of(query)), 5, allowed)) {
      const Place& found = places[candidate.keyframe.value];
      const auto result = recognize_place({frame, view_of(found.features, camera), sensor, options.tracking},
                                          options.loop, query);
      if (!result) continue;
      ++detection.confirmed;
      if (place.scene != found.scene) {
        ++detection.other_scene;
      } else if (!is_right(place, found, result->T_reference_camera)) {
        ++detection.off;
      }
      const bool has_same = std::any_of(places.begin(), places.end(), [&](const Place& other) {
        return is_admissible(place, other) && relation(place, other) == Relation::kSame;
      });
      if (has_same) ++detection.same;
      break;
    }
  }
  return detection;
}

}  // namespace kinloop
