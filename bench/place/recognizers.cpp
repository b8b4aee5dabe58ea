#include "bench/place/recognizers.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/flann.hpp>

#include "kinloop/base/parallel_for.hpp"
#include "kinloop/base/stopwatch.hpp"
#include "kinloop/loop/recognize.hpp"
#include "kinloop/place/descriptor_space.hpp"
#include "kinloop/place/place_search.hpp"

namespace kinloop {
namespace {

constexpr int kMaxDistance = 64;  ///< bits; farther descriptors do not vote

BowVector bow_of(const Place& place, const Vocabulary& vocabulary) {
  return vocabulary.bow_of(vocabulary.words_of(place.features.descriptors).words);
}

KeyframeId id_of(size_t place) {
  return {static_cast<uint32_t>(place)};
}

/// Asks for each image that has a pose; `ask` gives the candidates, best first.
Recognition recognize(std::span<const Place> places,
                      const std::function<std::vector<PlaceCandidate>(size_t query)>& ask) {
  Recognition recognition;
  size_t asked = 0;
  const Stopwatch watch;
  for (size_t query = 0; query < places.size(); ++query) {
    if (!places[query].T_room_camera) continue;
    ++asked;
    const auto found = ask(query);
    if (found.empty()) continue;
    recognition.answers.push_back({query, found[0].keyframe.value, found[0].score});
  }
  recognition.query_ms = 1000 * watch.cpu_s() / static_cast<double>(asked);
  return recognition;
}

/// The image with most votes; its share of the query's descriptors is the score.
std::vector<PlaceCandidate> most_voted(const std::vector<uint32_t>& votes, size_t descriptors) {
  const auto most = std::max_element(votes.begin(), votes.end());
  return {{id_of(static_cast<size_t>(most - votes.begin())),
           static_cast<double>(*most) / static_cast<double>(descriptors)}};
}

std::span<const BinaryDescriptor> rows_of(const cv::Mat& descriptors) {
  return as_points<HammingSpace>(std::span(descriptors.ptr(0), descriptors.total()));
}

/// Landmarks of one image, as seen from there.
LocalView view_of(const Features& features, const PinholeCamera& camera) {
  LocalView view;
  view.features = std::make_shared<const Features>(features);
  view.descriptors = cv::Mat(0, kOrbBytes, CV_8UC1);
  for (uint32_t i = 0; i < features.size(); ++i) {
    if (features.depths_m[i] <= 0) continue;
    const Eigen::Vector3d p = camera.unproject(features.pixels[i].cast<double>(), features.depths_m[i]);
    view.ids.push_back({i});
    view.p_reference.push_back(p);
    view.viewed_from.push_back(-p.normalized());
    view.seen_distance_m.push_back(p.norm());
    view.seen_level.push_back(features.levels[i]);
    view.descriptors.push_back(features.descriptors.row(static_cast<int>(i)));
  }
  return view;
}

/// Whether the pose that was found in the same room is that of the truth.
bool is_right(const Place& query, const Place& found, const SE3& T_found_query) {
  constexpr double kMost_m = 0.2, kMost_rad = 0.17;
  const SE3 error = (found.T_room_camera->inverse() * *query.T_room_camera).inverse() * T_found_query;
  return error.translation.norm() <= kMost_m && Eigen::AngleAxisd(error.rotation).angle() <= kMost_rad;
}

}  // namespace

Recognition by_words(std::span<const Place> places, const Vocabulary& vocabulary) {
  PlaceIndex index;
  for (size_t i = 0; i < places.size(); ++i) index.add(id_of(i), bow_of(places[i], vocabulary));
  return recognize(places, [&](size_t query) {
    return index.query(index.bow_of(id_of(query)), 1,
                       [&](KeyframeId id) { return may_be_found(places[query], places[id.value]); });
  });
}

Recognition by_arrangement(std::span<const Place> places, const Vocabulary& vocabulary) {
  PlaceSearch search;
  std::vector<ImageWords> words;
  for (size_t i = 0; i < places.size(); ++i) {
    const auto quantized = vocabulary.words_of(places[i].features.descriptors);
    words.push_back(image_words(places[i].features, quantized.words, vocabulary));
    search.add(id_of(i), vocabulary.bow_of(quantized.words), words.back());
  }
  return recognize(places, [&](size_t query) {
    return search.query(search.index().bow_of(id_of(query)), words[query], 1,
                        [&](KeyframeId id) { return may_be_found(places[query], places[id.value]); });
  });
}

Recognition by_brute_force(std::span<const Place> places) {
  return recognize(places, [&](size_t query) {
    const auto rows = rows_of(places[query].features.descriptors);
    std::vector<uint32_t> votes(places.size(), 0), winner(rows.size(), 0);
    parallel_for(rows.size(), hardware_threads(), [&](size_t begin, size_t end) {
      std::vector<uint32_t> nearest(end - begin), distance(end - begin);
      std::vector<uint32_t> best(end - begin, kMaxDistance + 1);
      for (size_t i = 0; i < places.size(); ++i) {
        if (i == query || !may_be_found(places[query], places[i])) continue;
        assign_to_nearest<HammingSpace>(rows.subspan(begin, end - begin),
                                        rows_of(places[i].features.descriptors), nearest.data(),
                                        distance.data());
        for (size_t j = 0; j < best.size(); ++j) {
          if (distance[j] >= best[j]) continue;
          best[j] = distance[j];
          winner[begin + j] = static_cast<uint32_t>(i + 1);
        }
      }
    });
    for (const uint32_t image : winner) {
      if (image > 0) ++votes[image - 1];
    }
    return most_voted(votes, rows.size());
  });
}

Recognition by_flann(std::span<const Place> places) {
  constexpr int kTables = 6, kKeyBits = 12, kProbes = 1;  // as OpenCV's documentation advises for ORB
  constexpr int kNeighbours = 20;                         // of which those too recent are left out
  cv::Mat all;
  std::vector<size_t> image_of;
  for (size_t i = 0; i < places.size(); ++i) {
    all.push_back(places[i].features.descriptors);
    image_of.resize(static_cast<size_t>(all.rows), i);
  }
  cv::flann::Index index(all, cv::flann::LshIndexParams(kTables, kKeyBits, kProbes),
                         cvflann::FLANN_DIST_HAMMING);
  return recognize(places, [&](size_t query) {
    const cv::Mat& descriptors = places[query].features.descriptors;
    cv::Mat indices(descriptors.rows, kNeighbours, CV_32S, cv::Scalar(-1)), distances;
    index.knnSearch(descriptors, indices, distances, kNeighbours);
    std::vector<uint32_t> votes(places.size(), 0);
    for (int row = 0; row < indices.rows; ++row) {
      for (int i = 0; i < kNeighbours; ++i) {
        const int found = indices.at<int>(row, i);
        if (found < 0 || found >= all.rows || distances.at<int>(row, i) > kMaxDistance) break;
        const size_t image = image_of[static_cast<size_t>(found)];
        if (image == query || !may_be_found(places[query], places[image])) continue;
        ++votes[image];
        break;
      }
    }
    return most_voted(votes, static_cast<size_t>(descriptors.rows));
  });
}

Detection detect(std::span<const Place> places, const Vocabulary& vocabulary, const PinholeCamera& camera) {
  const LoopOptions options;
  const TrackingOptions tracking;
  PlaceIndex index;
  for (size_t i = 0; i < places.size(); ++i) index.add(id_of(i), bow_of(places[i], vocabulary));
  Detection detection;
  for (size_t query = 0; query < places.size(); ++query) {
    const Place& place = places[query];
    if (!place.T_room_camera) continue;
    const auto allowed = [&](KeyframeId id) { return may_be_found(place, places[id.value]); };
    PreparedFrame frame;
    frame.features = std::make_shared<const Features>(place.features);
    for (const auto& candidate : index.query(index.bow_of(id_of(query)), 5, allowed)) {
      const Place& found = places[candidate.keyframe.value];
      const auto result =
          recognize_place(frame, view_of(found.features, camera), camera, options, tracking, query);
      if (!result) continue;
      ++detection.confirmed;
      if (place.room != found.room) {
        ++detection.other_room;
      } else if (!is_right(place, found, result->T_reference_camera)) {
        ++detection.off;
      }
      const bool has_same = std::any_of(places.begin(), places.end(), [&](const Place& other) {
        return may_be_found(place, other) && relation(place, other) == Relation::kSame;
      });
      if (has_same) ++detection.same;
      break;
    }
  }
  return detection;
}

}  // namespace kinloop
