#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "drivers/datasets/camera_files/fit_to_images.hpp"
#include "drivers/datasets/reading/images/depth_image.hpp"
#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/image_files/image_file.hpp"
#include "drivers/probe/sequence_statistics.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// The values of a grid of pixels of some images, without those that mean unknown.
std::vector<double> sampled_depth_units(const RecordedSequence& sequence) {
  constexpr size_t kImages = 5;
  constexpr int kGrid = 100;
  std::vector<double> units;
  const size_t step = std::max<size_t>(1, sequence.frames.size() / kImages);
  for (size_t i = 0; i < sequence.frames.size(); i += step) {
    const ImageLocation& location = sequence.frames[i].depth;
    try {
      const std::string bytes = read_bytes(location);
      if (!size_in_header(bytes)) continue;
      const cv::Mat depth = decode_depth(bytes, location.file, DepthEncoding::kImage, {}, 1);
      const int step_y = std::max(1, depth.rows / kGrid), step_x = std::max(1, depth.cols / kGrid);
      for (int y = 0; y < depth.rows; y += step_y) {
        for (int x = 0; x < depth.cols; x += step_x) {
          if (const float value = depth.at<float>(y, x); value > 0) units.push_back(value);
        }
      }
    } catch (const ImageFormatError&) {
      throw;  // of a kind that no image of the sequence may have
    } catch (const InputError&) {
      continue;  // damaged; the run counts it
    }
  }
  return units;
}

/// Millimetres times five. Few different values, such as those of a test image, tell nothing.
bool are_multiples_of_five(const std::vector<double>& units) {
  constexpr size_t kLeastDifferent = 30;
  constexpr int kFactor = 5;
  std::set<int> different;
  for (const double value : units) {
    if (std::fmod(value, kFactor) != 0) return false;
    if (different.size() < kLeastDifferent) different.insert(static_cast<int>(value));
  }
  return different.size() >= kLeastDifferent;
}

}  // namespace

bool has_floats_in_metres(const RecordedSequence& sequence) {
  constexpr double kFarthest_m = 100;
  constexpr size_t kTried = 3;  // the first may be damaged
  if (sequence.depth_encoding != DepthEncoding::kImage) return false;
  for (size_t i = 0; i < std::min(kTried, sequence.frames.size()); ++i) {
    const ImageLocation& location = sequence.frames[i].depth;
    try {
      if (!has_float_depth(read_bytes(location), location.file)) return false;
      const std::vector<double> values = sampled_depth_units(sequence);
      return !values.empty() && spread_of(values).median <= kFarthest_m;
    } catch (const InputError&) {
      continue;
    }
  }
  return false;
}

std::optional<DepthUnit> guess_depth_unit(const RecordedSequence& sequence) {
  constexpr double kMillimetres = 1000, kTumUnits = 5000, kNearest_m = 0.3, kFarthest_m = 5;
  if (sequence.depth_encoding != DepthEncoding::kImage) return std::nullopt;
  const std::vector<double> units = sampled_depth_units(sequence);
  if (units.empty()) return std::nullopt;
  const double median = spread_of(units).median;
  const auto plausible = [&](double scale) {
    return median >= kNearest_m * scale && median <= kFarthest_m * scale;
  };
  if (are_multiples_of_five(units) && plausible(kTumUnits)) return DepthUnit{kTumUnits, median / kTumUnits};
  if (plausible(kMillimetres)) return DepthUnit{kMillimetres, median / kMillimetres};
  const auto scale = plausible_depth_scale(median, 1);
  return scale ? std::optional(DepthUnit{*scale, median / *scale}) : std::nullopt;
}

}  // namespace kinloop
