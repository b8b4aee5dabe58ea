#include <algorithm>
#include <array>
#include <cmath>

#include "dense/live_mesh/tsdf_blocks.hpp"

namespace kinloop {
namespace {

constexpr size_t kEdge = kTsdfBlockEdge;

/// A view nearer than this to the centre of a block does not update it, m: its image would fill the view.
constexpr double kNearest_m = 0.2;

/// Colours are taken from views of a surface so near to the voxel, in voxels.
constexpr double kColored_voxels = 2;

/// Where the voxels of a block are in the image: (z col, z row, z) of its first one, and one voxel further
/// along each axis.
struct BlockInImage {
  Eigen::Vector3f first;
  std::array<Eigen::Vector3f, 3> step;
};

/// For each channel, red first, what the values of an image are with a gain.
using CompensatedValues = std::array<std::array<float, 256>, 3>;

CompensatedValues compensated_values(const ColorGain& gain) {
  constexpr float kBrightest = 255;
  CompensatedValues compensated{};
  for (size_t channel = 0; channel < compensated.size(); ++channel) {
    const float factor = gain[static_cast<Eigen::Index>(channel)];
    for (size_t value = 0; value < compensated[channel].size(); ++value)
      compensated[channel][value] = std::min(kBrightest, factor * static_cast<float>(value));
  }
  return compensated;
}

/// Updates the voxels of blocks by projecting them into a view.
class BlockFusion {
 public:
  BlockFusion(const FusionView& view, const DepthTiles& tiles, const SE3& T_camera_blocks,
              const TsdfScale& scale)
      : view_(view),
        tiles_(tiles),
        T_camera_blocks_(T_camera_blocks),
        scale_(scale),
        radius_m_(std::sqrt(3.0) / 2 * kTsdfBlockEdge * scale.voxel_m),
        truncation_m_(static_cast<float>(scale.truncation_m)),
        colored_m_(static_cast<float>(kColored_voxels * scale.voxel_m)),
        compensated_(compensated_values(view.color_gain)) {
    const PinholeCamera& camera = view.camera.color;
    K_ << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  }

  /// Returns whether any voxel changed.
  bool operator()(TsdfBlock& block) const {
    const Eigen::Vector3d first_m = voxel_of(block.first).cast<double>() * scale_.voxel_m;
    const double half_m = kTsdfBlockEdge / 2.0 * scale_.voxel_m;
    const Eigen::Vector3d center = T_camera_blocks_ * (first_m + Eigen::Vector3d::Constant(half_m));
    if (center.z() - radius_m_ < kNearest_m) return false;
    const double lag_s = view_.lag_s(view_.camera.color.project(center).y());
    const Eigen::Vector3d center_at_depth = at_depth(center, lag_s);
    if (center_at_depth.z() - radius_m_ < kNearest_m) return false;
    if (!may_change(block, center_at_depth)) return false;
    const auto [distance_weight, color_weight] = weights(center_at_depth.z());
    if (!update(*block.voxels, in_image(first_m, lag_s), distance_weight, color_weight)) return false;
    block.has_solid = std::ranges::any_of(
        *block.voxels, [](const TsdfVoxel& voxel) { return voxel.weight > 0 && voxel.distance < 0; });
    return true;
  }

 private:
  /// Whether the view may see something new in the block: neither is it hidden nor free as before.
  [[nodiscard]] bool may_change(const TsdfBlock& block, const Eigen::Vector3d& center) const {
    const PinholeCamera& camera = view_.camera.color;
    const Eigen::Vector2d pixel = camera.project(center);
    const double reach_px = radius_m_ * std::max(camera.fx, camera.fy) / (center.z() - radius_m_) + 1;
    const cv::Rect image(0, 0, camera.width, camera.height);
    const Eigen::Vector2i low = (pixel.array() - reach_px).floor().cast<int>(),
                          high = (pixel.array() + reach_px).ceil().cast<int>();
    const cv::Rect shown = image & cv::Rect(cv::Point(low.x(), low.y()), cv::Point(high.x(), high.y()));
    if (shown.empty()) return false;
    const DepthTiles::Range range = tiles_.range(shown);
    const auto z = static_cast<float>(center.z()), radius_m = static_cast<float>(radius_m_);
    if (z - radius_m > range.farthest_m + truncation_m_) return false;
    return block.has_solid || z + radius_m > range.nearest_m - truncation_m_;
  }

  /// The noise of depth is that at the block: free space far in front of a wall is as uncertain as the wall.
  [[nodiscard]] std::pair<float, float> weights(double z) const {
    const double ratio = view_.camera.noise.sigma_m(1) / view_.camera.noise.sigma_m(z);
    const auto in_units = [&](float units) {
      return std::max(1.0F, std::round(units * static_cast<float>(ratio * ratio)));
    };
    return {in_units(TsdfVoxel::kWeightUnits), in_units(TsdfVoxel::kColorWeightUnits)};
  }

  /// Where a point of the camera at the stamp is in the camera `lag_s` later, to first order.
  [[nodiscard]] Eigen::Vector3d at_depth(const Eigen::Vector3d& p_camera, double lag_s) const {
    return p_camera - lag_s * (view_.velocity.angular_rad_s.cross(p_camera) + view_.velocity.linear_m_s);
  }

  /// The block moves rigidly relative to the camera from the stamp to the time of its depth, which is that of
  /// the row of its centre.
  [[nodiscard]] BlockInImage in_image(const Eigen::Vector3d& first_m, double lag_s) const {
    const Eigen::Matrix3d turned = Eigen::Matrix3d::Identity() - lag_s * skew(view_.velocity.angular_rad_s);
    const Eigen::Matrix3d steps = K_ * turned * T_camera_blocks_.R() * scale_.voxel_m;
    return {(K_ * at_depth(T_camera_blocks_ * first_m, lag_s)).cast<float>(),
            {steps.col(0).cast<float>(), steps.col(1).cast<float>(), steps.col(2).cast<float>()}};
  }

  bool update(TsdfVoxels& voxels, const BlockInImage& block, float weight, float color_weight) const {
    bool changed = false;
    for (size_t i = 0; i < kTsdfBlockVoxels; i += kEdge) {
      const size_t row = i / kEdge % kEdge, layer = i / (kEdge * kEdge);
      const Eigen::Vector3f first =
          block.first + static_cast<float>(row) * block.step[1] + static_cast<float>(layer) * block.step[2];
      std::array<int, kEdge> cols{}, rows{};
      std::array<float, kEdge> z{};
      // Rounded without branches, so that it is vectorised: + 1.5 - 1, since a cast rounds towards zero.
      for (size_t x = 0; x < kEdge; ++x) {
        const auto along = static_cast<float>(x);
        z[x] = first.z() + along * block.step[0].z();
        const float inverse = 1 / z[x];
        cols[x] = static_cast<int>((first.x() + along * block.step[0].x()) * inverse + 1.5F) - 1;
        rows[x] = static_cast<int>((first.y() + along * block.step[0].y()) * inverse + 1.5F) - 1;
      }
      for (size_t x = 0; x < kEdge; ++x)
        changed |= update(voxels[i + x], cols[x], rows[x], z[x], weight, color_weight);
    }
    return changed;
  }

  bool update(TsdfVoxel& voxel, int col, int row, float z, float weight, float color_weight) const {
    if (static_cast<unsigned>(col) >= static_cast<unsigned>(view_.depth_m.cols) ||
        static_cast<unsigned>(row) >= static_cast<unsigned>(view_.depth_m.rows))
      return false;
    const float depth_m = view_.depth_m.ptr<float>(row)[col];
    const float ahead_m = std::abs(depth_m) - z;
    if (depth_m == 0 || ahead_m < -truncation_m_ || (depth_m < 0 && ahead_m < truncation_m_)) return false;
    const float measured = std::min(ahead_m / truncation_m_, 1.0F) * TsdfVoxel::kDistanceUnits;
    const float total = static_cast<float>(voxel.weight) + weight;
    const auto before = static_cast<float>(voxel.distance);
    voxel.distance = static_cast<int16_t>(before + (measured - before) * (weight / total));
    constexpr float kMaxWeight = 65535;
    voxel.weight = static_cast<uint16_t>(std::min(total, kMaxWeight));
    if (std::abs(ahead_m) < colored_m_) add_color(voxel, view_.color.ptr<cv::Vec3b>(row)[col], color_weight);
    return true;
  }

  void add_color(TsdfVoxel& voxel, const cv::Vec3b& bgr, float weight) const {
    const float total = static_cast<float>(voxel.color_weight) + weight;
    const float share = weight / total;
    for (size_t i = 0; i < 3; ++i) {
      const auto before = static_cast<float>(voxel.color[i]);
      const float measured = compensated_[i][bgr[2 - static_cast<int>(i)]];
      voxel.color[i] = static_cast<uint8_t>(std::lround(before + (measured - before) * share));
    }
    constexpr float kMaxWeight = 255;
    voxel.color_weight = static_cast<uint8_t>(std::min(total, kMaxWeight));
  }

  const FusionView& view_;
  const DepthTiles& tiles_;
  SE3 T_camera_blocks_;
  TsdfScale scale_;
  double radius_m_;  // of the ball around a block
  float truncation_m_, colored_m_;
  CompensatedValues compensated_;
  Eigen::Matrix3d K_;
};

}  // namespace

std::vector<ChangedBlock> fuse_view(TsdfBlocks& blocks, const FusionView& view, const DepthTiles& tiles,
                                    const SE3& T_camera_blocks, const TsdfScale& scale) {
  const BlockFusion fuse(view, tiles, T_camera_blocks, scale);
  std::vector<ChangedBlock> changed;
  for (uint32_t i = 0; i < blocks.all().size(); ++i) {
    const bool had_solid = blocks[i].has_solid;
    if (fuse(blocks[i])) changed.push_back({i, blocks[i].has_solid && !had_solid});
  }
  return changed;
}

}  // namespace kinloop
