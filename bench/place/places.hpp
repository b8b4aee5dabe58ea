#pragma once
// In: sequences with ground truth, and photographs of other places. Out: what a recogniser may find for an
// image, and what it should.

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
  std::optional<SE3> T_scene_camera;  ///< none: a photograph, which is never asked for
  Features features;
};

/// What it would mean to take one image for another.
enum class Relation {
  kSame,   ///< within 0.5 m and 30 degrees
  kNear,   ///< neither
  kOther,  ///< another scene, or farther away than 1 m, or turned by more than 60 degrees: no common view
};

/// Every `step`-th frame of a sequence in TUM layout with ground truth.
std::vector<Place> read_places(const std::filesystem::path& sequence, size_t scene, size_t step,
                               PinholeCamera& camera);

/// Photographs: every second image of the folder, from the second on (the others are trained on).
std::vector<Place> read_distractors(const std::filesystem::path& folder, size_t scene);

/// Descriptors of every second image of the folder, from the first on.
std::vector<cv::Mat> read_training_images(const std::filesystem::path& folder);

/// Whether `candidate` may be found for `query`: all of other scenes, of its own scene what is at least 10 s
/// old.
bool may_be_found(const Place& query, const Place& candidate);

/// `b` as an answer to `a`.
Relation relation(const Place& a, const Place& b);

/// The best answer to one query, and how sure.
struct Answer {
  size_t query = 0;
  size_t found = 0;
  double score = 0;
};

/// How well answers do as the score asked for falls.
struct Curve {
  std::vector<double> recall, precision;
  double recall_without_error = 0;  ///< recall at 100 % precision
  double strict_recall = 0;         ///< the same where kNear, too, counts as an error
};

/// `answers` to images of `places`: recall is the share of images with a kSame that may be found.
Curve curve_of(std::span<const Place> places, std::vector<Answer> answers);

/// Images of `places` for which there is something to find.
size_t count_findable(std::span<const Place> places);

}  // namespace kinloop
