#pragma once
// In: sequences with ground truth, and photographs of other places. Out: for each image, which images a
// recogniser may find and which it should.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// One image.
struct Place {
  size_t scene = 0;  ///< sequences are different scenes; images of different scenes never show the same place
  int64_t stamp_ns = 0;
  std::optional<SE3> T_scene_camera;  ///< nullopt: a photograph, which is never a query
  Features features;
};

/// How two images are related as query and answer.
enum class Relation {
  kSame,   ///< within 0.5 m and 30 degrees
  kNear,   ///< neither of the others
  kOther,  ///< another scene, or farther away than 1 m, or turned by more than 60 degrees: no common view
};

/// Reads every `step`-th frame of a sequence in TUM layout with ground truth.
std::vector<Place> read_places(const std::filesystem::path& sequence, size_t scene, size_t step,
                               PinholeCamera& camera);

/// Reads every second image of the folder, from the second on (the others are for training).
std::vector<Place> read_distractors(const std::filesystem::path& folder, size_t scene);

/// Returns the descriptors of every second image of the folder, from the first on.
std::vector<cv::Mat> read_training_images(const std::filesystem::path& folder);

/// Returns whether `candidate` is admissible for `query`: any image of other scenes; in its own scene only if
/// at least 10 s older.
bool is_admissible(const Place& query, const Place& candidate);

/// Classifies `b` as an answer to `a`.
Relation relation(const Place& a, const Place& b);

/// The best answer to one query, with its score.
struct Answer {
  size_t query = 0;
  size_t found = 0;
  double score = 0;
};

/// Precision and recall over the score threshold.
struct Curve {
  std::vector<double> recall, precision;
  double recall_without_error = 0;  ///< recall at 100 % precision
  double strict_recall = 0;         ///< same, if kNear also counts as an error
};

/// Computes the curve of `answers` to images of `places`; recall is the share of images with an admissible
/// kSame.
Curve curve_of(std::span<const Place> places, std::vector<Answer> answers);

/// Returns the number of images of `places` with an admissible kSame.
size_t count_queries_with_answer(std::span<const Place> places);

}  // namespace kinloop
