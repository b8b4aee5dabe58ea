#include "kinloop/features/matcher.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinloop/core/errors.hpp"
#include "kinloop/features/hamming.hpp"
#include "kinloop/features/kernels/hamming_rows.hpp"

namespace kinloop {
namespace {

constexpr int kFar = std::numeric_limits<int>::max();
constexpr int kCellPx = 16;

/// For each row of `a` the key of its nearest row in `b`, and vice versa.
struct MutualNearest {
  std::vector<uint32_t> of_a, of_b;
};

MutualNearest find_nearest(const cv::Mat& a, const cv::Mat& b) {
  const TransposedDescriptors transposed(b.ptr<uint8_t>(), static_cast<size_t>(b.rows));
  std::vector<uint16_t> distances(transposed.padded_count());
  MutualNearest nearest{{}, std::vector<uint32_t>(transposed.padded_count(), kNoKey)};
  for (int i = 0; i < a.rows; ++i) {
    transposed.distances_from(a.ptr<uint8_t>(i), distances);
    nearest.of_a.push_back(nearest_key(distances, static_cast<uint32_t>(i), nearest.of_b.data()));
  }
  return nearest;
}

/// The best and second-best keypoint in a search window.
struct TwoBestMatches {
  uint32_t index = 0;
  int distance = kFar, second_distance = kFar;
  int level = -1, second_level = -1;

  void offer(uint32_t candidate, int candidate_distance, int candidate_level) {
    if (candidate_distance < distance) {
      second_distance = distance;
      second_level = level;
      index = candidate;
      distance = candidate_distance;
      level = candidate_level;
    } else if (candidate_distance < second_distance) {
      second_distance = candidate_distance;
      second_level = candidate_level;
    }
  }

  /// A similar keypoint on the same level makes the match ambiguous.
  [[nodiscard]] bool distinct(double max_ratio) const {
    return second_distance == kFar || level != second_level || distance <= max_ratio * second_distance;
  }
};

bool plausible(const ProjectedPoint& point, const Features& features, uint32_t i, double max_depth_error) {
  if (features.levels[i] < point.level_low || features.levels[i] > point.level_high) return false;
  const double depth_m = features.depths_m[i];
  return depth_m <= 0 || std::abs(depth_m - point.depth_m) <= max_depth_error * point.depth_m;
}

/// Row or column of a position in cells; that at the border for one outside, the first one for NaN.
int nearest_cell(double position, int count) {
  if (!(position > 0)) return 0;
  return position < count - 1 ? static_cast<int>(position) : count - 1;
}

}  // namespace

std::vector<Match> match_brute_force(const cv::Mat& a, const cv::Mat& b, bool cross_check) {
  if (a.empty() || b.empty()) return {};
  require(a.cols == kOrbBytes && b.cols == kOrbBytes && a.isContinuous() && b.isContinuous(),
          "match_brute_force: expected continuous N x 32 binary descriptors");
  require(std::max(a.rows, b.rows) < 1 << kIndexBits, "match_brute_force: too many descriptors");
  const MutualNearest nearest = find_nearest(a, b);
  std::vector<Match> matches;
  for (uint32_t i = 0; i < nearest.of_a.size(); ++i) {
    const uint32_t j = index_of_key(nearest.of_a[i]);
    if (cross_check && index_of_key(nearest.of_b[j]) != i) continue;
    matches.push_back({i, j, distance_of_key(nearest.of_a[i])});
  }
  return matches;
}

std::vector<Match> filter_matches_by_distance(std::span<const Match> matches, double factor, int floor) {
  int smallest = kFar;
  for (const Match& match : matches) smallest = std::min(smallest, match.distance);
  std::vector<Match> kept;
  for (const Match& match : matches) {
    if (match.distance <= std::max<double>(factor * smallest, floor)) kept.push_back(match);
  }
  return kept;
}

FeatureGrid::FeatureGrid(const Features& features, int width_px, int height_px)
    : columns_(width_px / kCellPx + 1), rows_(height_px / kCellPx + 1) {
  const auto cell_of = [&](const Eigen::Vector2f& pixel) {
    return cell_index(row_of(pixel.y()), column_of(pixel.x()));
  };
  first_of_cell_.assign(cell_index(rows_, 0) + 1, 0);
  for (const auto& pixel : features.pixels) ++first_of_cell_[cell_of(pixel) + 1];
  for (size_t c = 1; c < first_of_cell_.size(); ++c) first_of_cell_[c] += first_of_cell_[c - 1];
  std::vector<uint32_t> next(first_of_cell_.begin(), first_of_cell_.end() - 1);
  indices_.resize(features.size());
  for (uint32_t i = 0; i < features.size(); ++i) indices_[next[cell_of(features.pixels[i])]++] = i;
  pixels_.reserve(features.size());
  for (const uint32_t i : indices_) pixels_.push_back(features.pixels[i]);
}

size_t FeatureGrid::cell_index(int row, int column) const {
  return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
}

int FeatureGrid::column_of(double x) const {
  return nearest_cell(x / kCellPx, columns_);
}

int FeatureGrid::row_of(double y) const {
  return nearest_cell(y / kCellPx, rows_);
}

void FeatureGrid::features_in_area(const Eigen::Vector2d& pixel, double radius_px,
                                   std::vector<uint32_t>& found) const {
  const int column_begin = column_of(pixel.x() - radius_px), column_end = column_of(pixel.x() + radius_px);
  const int row_end = row_of(pixel.y() + radius_px);
  const auto is_near = [&](const Eigen::Vector2f& other) {
    return std::abs(static_cast<double>(other.x()) - pixel.x()) <= radius_px &&
           std::abs(static_cast<double>(other.y()) - pixel.y()) <= radius_px;
  };
  size_t count = 0;
  for (int row = row_of(pixel.y() - radius_px); row <= row_end; ++row) {
    const uint32_t begin = first_of_cell_[cell_index(row, column_begin)];
    const uint32_t end = first_of_cell_[cell_index(row, column_end) + 1];
    found.resize(count + end - begin);
    for (uint32_t k = begin; k < end; ++k) {
      found[count] = indices_[k];
      count += static_cast<size_t>(is_near(pixels_[k]));  // without a branch, which would often go wrong
    }
  }
  found.resize(count);
}

std::vector<Match> match_by_projection(std::span<const ProjectedPoint> points, const Features& features,
                                       const FeatureGrid& grid, const ProjectionMatchOptions& options) {
  require(
      features.size() == 0 || (features.descriptors.type() == CV_8UC1 &&
                               features.descriptors.cols == kOrbBytes && features.descriptors.isContinuous()),
      "match_by_projection: expected continuous N x 32 binary descriptors");
  constexpr uint32_t kNobody = std::numeric_limits<uint32_t>::max();
  std::vector<Match> owner_of(features.size(), Match{kNobody, 0, kFar});
  std::vector<uint32_t> nearby;
  std::vector<uint16_t> distances;
  for (uint32_t p = 0; p < points.size(); ++p) {
    const ProjectedPoint& point = points[p];
    grid.features_in_area(point.pixel, point.radius_px, nearby);
    std::erase_if(nearby,
                  [&](uint32_t i) { return !plausible(point, features, i, options.max_depth_error); });
    distances.resize(nearby.size());
    hamming_to_rows(point.descriptor, features.descriptors.ptr<uint8_t>(), nearby, distances.data());
    TwoBestMatches nearest;
    for (size_t k = 0; k < nearby.size(); ++k) {
      nearest.offer(nearby[k], distances[k], features.levels[nearby[k]]);
    }
    if (nearest.distance > options.max_distance || !nearest.distinct(options.max_ratio)) continue;
    Match& owner = owner_of[nearest.index];
    if (nearest.distance < owner.distance) owner = {p, nearest.index, nearest.distance};
  }
  std::vector<Match> matches;
  for (const Match& owner : owner_of) {
    if (owner.a != kNobody) matches.push_back(owner);
  }
  std::sort(matches.begin(), matches.end());
  return matches;
}

}  // namespace kinloop
