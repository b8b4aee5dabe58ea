#include "simulator/depth_camera.hpp"

#include "simulator/multipath.hpp"

namespace kinloop::sim {
namespace {

SamplesPerPixel samples(const RgbdCamera& camera, const DepthCameraNoise& noise) {
  const bool mixed = camera.sensor.kind == DepthSensorKind::kTimeOfFlight && noise.tof.flying_pixels;
  return mixed ? SamplesPerPixel::kFour : SamplesPerPixel::kOne;
}

}  // namespace

DepthCamera::DepthCamera(const Scene& scene, const RgbdCamera& camera, const DepthCameraNoise& noise,
                         int threads)
    : scene_(&scene),
      camera_(camera.depth.value()),
      T_color_depth_(camera.T_color_depth),
      kind_(camera.sensor.kind),
      noise_(noise),
      threads_(threads),
      renderer_(scene, camera_, samples(camera, noise), threads) {}

cv::Mat DepthCamera::measure(const SE3& T_room_color, uint64_t seed) const {
  const SE3 T_room_depth = T_room_color * T_color_depth_;
  const ExactDepth exact = renderer_.render(T_room_depth);
  if (kind_ == DepthSensorKind::kStereo)
    return matched_depth(exact, camera_.fx * kStereoBaseline_m, noise_.stereo, seed, threads_);
  TimeOfFlightView view{exact, renderer_.range_per_depth(), {}};
  if (noise_.tof.multipath) view.range_error_m = multipath_error_m(*scene_, camera_, T_room_depth, threads_);
  return measured_depth(view, noise_.tof, seed, threads_);
}

}  // namespace kinloop::sim
