#include <algorithm>
#include <array>
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

/// Positions at uneven distances: the values of a slope at even ones would have a divisor in common.
int uneven(int i, int step) {
  return i * step + i * i % step;
}

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
      for (int row = 0; uneven(row, step_y) < depth.rows; ++row) {
        for (int column = 0; uneven(column, step_x) < depth.cols; ++column) {
          const float value = depth.at<float>(uneven(row, step_y), uneven(column, step_x));
          if (value > 0) units.push_back(value);
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

/// The largest number up to 100 that divides nearly all values: some pixels may be interpolated. 1 if few
/// values differ, such as those of a test image, which tell nothing.
int common_divisor(const std::vector<double>& units) {
  constexpr size_t kLeastDifferent = 30;
  constexpr double kShare = 0.95;
  constexpr int kLargest = 100;
  std::set<int> different;
  for (const double value : units) {
    if (different.size() < kLeastDifferent) different.insert(static_cast<int>(value));
  }
  if (different.size() < kLeastDifferent) return 1;
  for (int divisor = kLargest; divisor > 1; --divisor) {
    const auto divided = std::count_if(units.begin(), units.end(),
                                       [&](double value) { return std::fmod(value, divisor) == 0; });
    if (static_cast<double>(divided) >= kShare * static_cast<double>(units.size())) return divisor;
  }
  return 1;
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
  constexpr double kMillimetres = 1000, kNearest_m = 0.3, kFarthest_m = 5;
  constexpr std::array kUsual = {kMillimetres, 5000.0, 10000.0, 4000.0};
  if (sequence.depth_encoding != DepthEncoding::kImage) return std::nullopt;
  const std::vector<double> units = sampled_depth_units(sequence);
  if (units.empty()) return std::nullopt;
  const double median = spread_of(units).median;
  const auto plausible = [&](double scale) {
    return median >= kNearest_m * scale && median <= kFarthest_m * scale;
  };
  DepthUnit unit;
  const int divisor = common_divisor(units);
  if (plausible(kMillimetres * divisor)) {
    unit.divisor = divisor;
    unit.depth_scale = kMillimetres * divisor;
  } else if (plausible(kMillimetres)) {
    unit.depth_scale = kMillimetres;
  } else if (const auto scale = plausible_depth_scale(median, 1)) {
    unit.depth_scale = *scale;
  } else {
    return std::nullopt;
  }
  unit.median_m = median / unit.depth_scale;
  const auto* other = std::find_if(kUsual.begin(), kUsual.end(), [&](double scale) {
    return scale != unit.depth_scale && plausible(scale);
  });
  if (other != kUsual.end()) unit.other_scale = *other, unit.other_median_m = median / *other;
  return unit;
}

}  // namespace kinloop
