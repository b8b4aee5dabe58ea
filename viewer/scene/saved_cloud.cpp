#include "viewer/scene/saved_cloud.hpp"

#include <algorithm>

#include <Eigen/Geometry>

#include "viewer/scene/incremental_cloud.hpp"

namespace kinloop {
namespace {

constexpr size_t kPiecePoints = 1 << 16;       // largest piece that a browser processes at once
constexpr size_t kFirstPiecePoints = 1 << 14;  // which a slow connection soon has: the first picture

/// A multiple of the box that holds nine tenths of the points per coordinate.
Eigen::AlignedBox3f outlier_fence(const ColoredCloud& mixed) {
  constexpr size_t kSample = 10000;
  constexpr float kTimes = 10;
  const size_t count = std::min(kSample, mixed.size());
  Eigen::AlignedBox3f box;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    for (size_t i = 0; i < count; ++i) values.push_back(mixed.points[i][axis]);
    std::sort(values.begin(), values.end());
    const float low = values[count / 20], high = values[count - 1 - count / 20];
    box.min()[axis] = low - kTimes * (high - low);
    box.max()[axis] = high + kTimes * (high - low);
  }
  return box;
}

void append_pieces(const ColoredCloud& cloud, std::vector<CloudPiece>& pieces) {
  for (size_t first = 0, next = 0; first < cloud.size(); first = next) {
    next = std::min(cloud.size(), first + (pieces.empty() ? kFirstPiecePoints : kPiecePoints));
    const auto begin = static_cast<long>(first), end = static_cast<long>(next);
    CloudPiece piece;
    piece.cloud.points.assign(cloud.points.begin() + begin, cloud.points.begin() + end);
    piece.cloud.colors.assign(cloud.colors.begin() + begin, cloud.colors.begin() + end);
    pieces.push_back(std::move(piece));
  }
}

}  // namespace

std::vector<CloudPiece> split_into_pieces(const ColoredCloud& cloud) {
  std::vector<CloudPiece> pieces;
  const ColoredCloud mixed = shuffled(cloud);
  if (mixed.size() == 0) return pieces;
  const Eigen::AlignedBox3f box = outlier_fence(mixed);
  ColoredCloud near, far;
  for (size_t i = 0; i < mixed.size(); ++i) {
    ColoredCloud& part = box.contains(mixed.points[i]) ? near : far;
    part.points.push_back(mixed.points[i]);
    part.colors.push_back(mixed.colors[i]);
  }
  append_pieces(near, pieces);
  append_pieces(far, pieces);
  return pieces;
}

}  // namespace kinloop
