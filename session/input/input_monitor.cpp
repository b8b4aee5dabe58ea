#include "session/input/input_monitor.hpp"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "session/input/checks/checks.hpp"
#include "session/input/focal_length.hpp"

namespace kinloop {
namespace {

constexpr const char* kModule = "input checks";

/// Whether the map fits other focal lengths than those of the camera.
std::optional<InputWarning> check_focal_length(const Slam& slam, const PinholeCamera& camera) {
  const auto found =
      estimate_focal_length(slam.map(), slam.sensor_estimate(), keyframe_velocities(slam.log(), slam.map()));
  if (!found || !found->contradicts_camera()) return std::nullopt;
  return InputWarning{
      InputFault::kFocalLength,
      fmt::format("the map fits {:.3f} (+- {:.3f}) times the focal length of the camera, more than "
                  "self-calibration may correct",
                  0.5 * (found->factor_x + found->factor_y), found->sigma_x),
      fmt::format("calibrate the camera, or try fx: {:.0f}, fy: {:.0f} instead of {:.1f}, {:.1f}",
                  found->factor_x * camera.fx, found->factor_y * camera.fy, camera.fx, camera.fy),
      false};
}

/// nullopt if no depth_scale applies.
std::optional<double> stored_depth_scale(const RgbdCamera& camera) {
  return camera.has_metric_depth ? std::nullopt : std::optional(camera.depth_scale);
}

}  // namespace

void InputMonitor::observe(const Frame& frame) {
  const ScopedTimer timer(timings_, kModule);
  auto found = checker_.observe(frame);
  for (const InputWarning& warning : found) {
    if (warning.hopeless) throw InputError(text_of(warning));
  }
  keep(std::move(found));
}

void InputMonitor::finish(const Slam& slam, const Trajectory& truth) {
  const ScopedTimer timer(timings_, kModule);
  if (std::exchange(finished_, true)) return;
  keep(checker_.finish());
  // Most other faults also contradict the focal length, and a wrong one makes the path larger or smaller.
  if (!warnings_.empty()) return;
  if (auto warning = check_focal_length(slam, camera_.color)) return keep({*std::move(warning)});
  if (auto warning = check_path_scale(slam.trajectory(), truth, stored_depth_scale(camera_)))
    keep({*std::move(warning)});
}

void InputMonitor::keep(std::vector<InputWarning> found) {
  for (InputWarning& warning : found) {
    log::warn("{}", text_of(warning));
    warnings_.push_back(std::move(warning));
  }
}

}  // namespace kinloop
