#include "dense/live_mesh/fusion_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "dense/cloud/color_gains.hpp"
#include "dense/undistorted_images.hpp"
#include "dense/usable_depth.hpp"
#include "kinloop/core/quantile.hpp"

namespace kinloop {
namespace {

constexpr int kTileEdgePx = 16;

constexpr DepthTiles::Range kUnknown{std::numeric_limits<float>::infinity(), 0};

DepthTiles::Range joined(const DepthTiles::Range& a, const DepthTiles::Range& b) {
  return {std::min(a.nearest_m, b.nearest_m), std::max(a.farthest_m, b.farthest_m)};
}

}  // namespace

std::optional<ColorGain> view_gain(const std::vector<ColorPair>& pairs) {
  constexpr size_t kFewest = 50;
  constexpr float kMost = 3;
  std::array<std::vector<float>, 3> ratios;
  for (const auto& [view, mesh] : pairs) {
    if (!is_well_exposed(view) || !is_well_exposed(mesh)) continue;
    for (size_t i = 0; i < 3; ++i)
      ratios[i].push_back(static_cast<float>(mesh[i]) / static_cast<float>(view[i]));
  }
  if (ratios[0].size() < kFewest) return std::nullopt;
  ColorGain gain;
  for (size_t i = 0; i < 3; ++i)
    gain[static_cast<Eigen::Index>(i)] = std::clamp(median(std::move(ratios[i])), 1 / kMost, kMost);
  return gain;
}

FusionView make_fusion_view(const RgbdImages& images, const DenseCamera& camera, const cv::Mat& raw_pixels,
                            const DepthLimits& limits) {
  FusionView view{.camera = camera, .color = undistorted(images.color, raw_pixels), .depth_m = {}};
  view.camera.color.lens = {};
  const cv::Mat usable = undistorted(usable_pixels(images.depth_m, camera.color.fx, limits), raw_pixels);
  view.depth_m = undistorted(images.depth_m, raw_pixels).clone();
  for (int row = 0; row < view.depth_m.rows; ++row) {
    auto* depth_m = view.depth_m.ptr<float>(row);
    const auto* is_usable = usable.ptr<uint8_t>(row);
    for (int col = 0; col < view.depth_m.cols; ++col) {
      const bool known = depth_m[col] > 0 && std::isfinite(depth_m[col]);
      depth_m[col] = !known ? 0 : is_usable[col] != 0 ? depth_m[col] : -depth_m[col];
    }
  }
  return view;
}

std::vector<Eigen::Vector3f> sampled_surface(const FusionView& view, int stride_px) {
  std::vector<Eigen::Vector3f> points;
  for (int row = stride_px / 2; row < view.depth_m.rows; row += stride_px) {
    for (int col = stride_px / 2; col < view.depth_m.cols; col += stride_px) {
      const float depth_m = view.depth_m.at<float>(row, col);
      if (!(depth_m > 0)) continue;
      const Eigen::Vector3d p =
          view.camera.color.unproject(Eigen::Vector2d(col, row), static_cast<double>(depth_m));
      points.push_back(
          view.camera.deskew(p, row, view.velocity, view.depth_stamp_difference_s).cast<float>());
    }
  }
  return points;
}

std::optional<Rgb> color_at(const FusionView& view, const Eigen::Vector3f& p_camera) {
  const Eigen::Vector2d pixel = view.camera.color.project(p_camera.cast<double>());
  if (!view.camera.color.contains(pixel, 1)) return std::nullopt;
  const auto& bgr = view.color.at<cv::Vec3b>(
      cv::Point(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))));
  return Rgb{bgr[2], bgr[1], bgr[0]};
}

DepthTiles::DepthTiles(const cv::Mat& depth_m) : columns_((depth_m.cols + kTileEdgePx - 1) / kTileEdgePx) {
  const int rows = (depth_m.rows + kTileEdgePx - 1) / kTileEdgePx;
  tiles_.resize(index(rows, 0), kUnknown);
  for (int row = 0; row < depth_m.rows; ++row) {
    Range* tiles = &tiles_[index(row / kTileEdgePx, 0)];
    const auto* depths_m = depth_m.ptr<float>(row);
    for (int col = 0; col < depth_m.cols; ++col) {
      const float z = std::abs(depths_m[col]);
      if (z > 0) tiles[col / kTileEdgePx] = joined(tiles[col / kTileEdgePx], {z, z});
    }
  }
}

DepthTiles::Range DepthTiles::range(const cv::Rect& pixels) const {
  Range found = kUnknown;
  const cv::Point last = pixels.br() - cv::Point(1, 1);
  for (int row = pixels.y / kTileEdgePx; row <= last.y / kTileEdgePx; ++row) {
    for (int col = pixels.x / kTileEdgePx; col <= last.x / kTileEdgePx; ++col)
      found = joined(found, tiles_[index(row, col)]);
  }
  return found;
}

}  // namespace kinloop
