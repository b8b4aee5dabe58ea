#include "bench/place/places.hpp"

#include <algorithm>
#include <numbers>

#include "drivers/datasets/tum_source.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/features/extraction/extractor.hpp"
#include "kinloop/sensor/sensor.hpp"
#include "tools/vocabulary_training/descriptors/training_images.hpp"

namespace kinloop {
namespace {

constexpr double kSame_m = 0.5, kSame_rad = std::numbers::pi / 6;
constexpr double kOther_m = 1.0, kOther_rad = std::numbers::pi / 3;
constexpr int64_t kGapNs = 10 * kNsPerSecond;

/// Every second image, starting with `first`.
std::vector<std::filesystem::path> every_second_image(const std::filesystem::path& folder, size_t first) {
  const auto all = list_training_input(std::vector{folder}).images;
  std::vector<std::filesystem::path> half;
  for (size_t i = first; i < all.size(); i += 2) half.push_back(all[i]);
  return half;
}

/// Recall at the last score before an error.
double recall_at_threshold(std::span<const Place> places, std::span<const Answer> sorted,
                           bool near_is_error) {
  size_t right = 0;
  for (const Answer& answer : sorted) {
    const Relation is = relation(places[answer.query], places[answer.found]);
    if (is == Relation::kOther || (near_is_error && is == Relation::kNear)) break;
    if (is == Relation::kSame) ++right;
  }
  return static_cast<double>(right) / static_cast<double>(count_queries_with_answer(places));
}

}  // namespace

std::vector<Place> read_places(const std::filesystem::path& sequence, size_t scene, size_t step,
                               PinholeCamera& camera) {
  TumSource source(sequence);
  camera = source.camera().color;
  std::vector<Place> places;
  for (size_t i = 0; const auto frame = source.next(); ++i) {
    const auto pose = pose_at(source.info().ground_truth, frame->stamp_ns, kNsPerSecond / 10);
    if (i % step != 0 || !pose) continue;
    places.push_back({scene, frame->stamp_ns, pose,
                      extract_features(frame->color.gray(), frame->depth_m, Sensor{camera}, {})});
  }
  return places;
}

std::vector<Place> read_distractors(const std::filesystem::path& folder, size_t scene) {
  std::vector<Place> places;
  describe_images(every_second_image(folder, 1), {}, {},
                  [&](const auto&, const std::optional<cv::Mat>& descriptors) {
                    if (!descriptors || descriptors->empty()) return;
                    Place place;
                    place.scene = scene;
                    place.features.descriptors = *descriptors;
                    const auto size = static_cast<size_t>(descriptors->rows);
                    place.features.pixels.resize(size, Eigen::Vector2f::Zero());
                    place.features.levels.resize(size, 0);
                    place.features.angles_rad.resize(size, 0);
                    place.features.depths_m.resize(size, 0);
                    places.push_back(std::move(place));
                  });
  return places;
}

std::vector<cv::Mat> read_training_images(const std::filesystem::path& folder) {
  DescribeOptions description;
  description.features.count = 2000;
  description.threads = hardware_threads();
  std::vector<cv::Mat> images;
  describe_images(every_second_image(folder, 0), description, {},
                  [&](const auto&, const std::optional<cv::Mat>& descriptors) {
                    if (descriptors) images.push_back(*descriptors);
                  });
  return images;
}

bool is_admissible(const Place& query, const Place& candidate) {
  return query.scene != candidate.scene || candidate.stamp_ns + kGapNs <= query.stamp_ns;
}

Relation relation(const Place& a, const Place& b) {
  if (a.scene != b.scene || !a.T_scene_camera || !b.T_scene_camera) return Relation::kOther;
  const SE3 T_a_b = a.T_scene_camera->inverse() * *b.T_scene_camera;
  const double distance_m = T_a_b.translation.norm();
  const double turn_rad = Eigen::AngleAxisd(T_a_b.rotation).angle();
  if (distance_m <= kSame_m && turn_rad <= kSame_rad) return Relation::kSame;
  return distance_m > kOther_m || turn_rad > kOther_rad ? Relation::kOther : Relation::kNear;
}

Curve curve_of(std::span<const Place> places, std::vector<Answer> answers) {
  std::stable_sort(answers.begin(), answers.end(),
                   [](const Answer& a, const Answer& b) { return a.score > b.score; });
  Curve curve;
  const auto findable_count = static_cast<double>(count_queries_with_answer(places));
  double right = 0, wrong = 0;
  for (const Answer& answer : answers) {
    const Relation is = relation(places[answer.query], places[answer.found]);
    if (is == Relation::kNear) continue;
    (is == Relation::kSame ? right : wrong) += 1;
    curve.recall.push_back(right / findable_count);
    curve.precision.push_back(right / (right + wrong));
  }
  curve.recall_without_error = recall_at_threshold(places, answers, false);
  curve.strict_recall = recall_at_threshold(places, answers, true);
  return curve;
}

size_t count_queries_with_answer(std::span<const Place> places) {
  return static_cast<size_t>(std::count_if(places.begin(), places.end(), [&](const Place& query) {
    return query.T_scene_camera && std::any_of(places.begin(), places.end(), [&](const Place& other) {
             return is_admissible(query, other) && relation(query, other) == Relation::kSame;
           });
  }));
}

}  // namespace kinloop
