#include "kinloop/tracking/direct/patch_search.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "kinloop/tracking/direct/alignment.hpp"

namespace kinloop {
namespace {

constexpr double kMinAreaRatio = 0.15;
constexpr int kOctaves = 3;

}  // namespace

PatchPredictor::PatchPredictor(const PatchSearch& search, const SE3& T_reference_camera)
    : search_(search), T_camera_reference_(T_reference_camera.inverse()) {
  for (const LocalView& view : search_.local_map.views)
    T_camera_view_.push_back(T_camera_reference_ * view.T_keyframe_reference.inverse());
}

std::optional<Eigen::Vector2d> PatchPredictor::nominal_pixel(uint32_t index) const {
  const Eigen::Vector3d p_camera = T_camera_reference_ * search_.local_map.p_reference[index];
  if (!(p_camera.z() > 0)) return std::nullopt;
  return search_.sensor.camera.distort(search_.sensor.camera.project(p_camera));
}

std::optional<Eigen::Vector2d> PatchPredictor::raw_pixel(uint32_t index) const {
  return raw_pixel_of(search_.sensor, T_camera_reference_ * search_.local_map.p_reference[index],
                      search_.velocity);
}

std::optional<ExpectedPatch> PatchPredictor::expect(uint32_t index, const Eigen::Vector2d& raw) const {
  const LocalMap& map = search_.local_map;
  const PinholeCamera& camera = search_.sensor.camera;
  const LocalView& view = map.views[map.view_of[index]];
  const uint32_t feature = map.feature_of[index];
  const Patch* patch = view.patches ? view.patches->find(feature) : nullptr;
  if (patch == nullptr) return std::nullopt;
  // Follow two neighbours of the keypoint on its surface into the frame.
  constexpr double kStep_px = 4;
  const Eigen::Vector3d p_view = view.T_keyframe_reference * map.p_reference[index];
  const Eigen::Vector2d center = camera.project(p_view);
  const Eigen::Vector2d raw_center = camera.distort(center);
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  if (!view.features->inverse_depth_gradients.empty()) {
    slope = view.features->inverse_depth_gradients[feature].cast<double>();
    if (!slope.allFinite()) slope.setZero();
  }
  Eigen::Matrix2d view_steps, frame_steps;
  const auto seen = camera.project(T_camera_view_[map.view_of[index]] * p_view);
  const Eigen::Vector2d distorted = camera.distort(seen);
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d neighbor = center + kStep_px * Eigen::Vector2d::Unit(axis);
    const double inverse_depth = 1 / p_view.z() + kStep_px * slope(axis);
    if (!(inverse_depth > 0)) return std::nullopt;
    const Eigen::Vector3d p_neighbor =
        T_camera_view_[map.view_of[index]] * camera.unproject(neighbor, 1 / inverse_depth);
    if (!(p_neighbor.z() > 0)) return std::nullopt;
    view_steps.col(axis) = camera.distort(neighbor) - raw_center;
    frame_steps.col(axis) = camera.distort(camera.project(p_neighbor)) - distorted;
  }
  const double ratio = std::abs(frame_steps.determinant() / view_steps.determinant());
  if (!std::isfinite(ratio) || !(ratio > kMinAreaRatio) || !(ratio < 1 / kMinAreaRatio)) return std::nullopt;
  const Eigen::Matrix2d warp = view_steps * frame_steps.inverse();
  const int octave = std::clamp(patch->octave + static_cast<int>(std::lround(std::log2(ratio) / 2)), 0,
                                static_cast<int>(kOctaves) - 1);
  return ExpectedPatch{index, raw, octave, warp};
}

std::optional<FoundPatch> find_patch(const ImageOctaves& octaves, const ExpectedPatch& expected,
                                     const LocalMap& map, float max_shift_px) {
  constexpr float kMinCorrelation = 0.9F;
  const Patch& patch = *map.views[map.view_of[expected.index]].patches->find(map.feature_of[expected.index]);
  const int octave = std::min(expected.octave, static_cast<int>(octaves.size()) - 1);
  const Eigen::Matrix2d source_per_target = expected.warp * std::ldexp(1.0, octave - patch.octave);
  const auto made = make_template(patch, source_per_target.cast<float>());
  if (!made) return std::nullopt;
  const Eigen::Vector2d guess = to_octave(expected.raw, octave);
  const auto found =
      align_patch(*made, octaves[static_cast<size_t>(octave)], guess.cast<float>(), max_shift_px);
  if (!found || found->correlation < kMinCorrelation) return std::nullopt;
  return FoundPatch{expected.index, from_octave(found->position.cast<double>(), octave), octave};
}

}  // namespace kinloop
