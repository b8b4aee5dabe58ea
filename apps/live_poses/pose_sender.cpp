#include "apps/live_poses/pose_sender.hpp"

#include <system_error>
#include <utility>

#include "apps/run/frame_recorder.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/map/frames/pose_covariance.hpp"

namespace kinloop {
namespace {

using Json = nlohmann::ordered_json;

Json transform_json(const SE3& T) {
  const auto& t = T.translation;
  const auto& q = T.rotation;
  return {{"translation", {t.x(), t.y(), t.z()}}, {"quaternion", {q.x(), q.y(), q.z(), q.w()}}};
}

}  // namespace

std::string pose_line(const TrackedFrame& tracked, const Map& map) {
  Json line = {{"stamp_ns", tracked.stamp_ns},
               {"status", frame_status(tracked)},
               {"component", nullptr},
               {"T_map_camera", nullptr},
               {"sigma_m", nullptr},
               {"covariance", nullptr},
               {"T_map_odom", transform_json(tracked.T_map_odom)}};
  if (!tracked.is_lost()) {
    line["component"] = map.keyframe(tracked.reference).component;
    line["T_map_camera"] = transform_json(tracked.T_world_camera);
  }
  if (const auto covariance = pose_covariance(tracked)) {
    line["sigma_m"] = position_sigma_m(*covariance);
    line["covariance"] = upper_triangle(*covariance);
  }
  return ordered_json_text(line) + "\n";
}

PoseSender::PoseSender(std::string target) : target_(std::move(target)), output_(open_line_output(target_)) {}

void PoseSender::send(const TrackedFrame& tracked, const Map& map) {
  ++lines_;
  if (output_->write(pose_line(tracked, map))) return;
  if (output_->error() == 0) {
    ++dropped_;
  } else if (failed_++ == 0) {
    error_ = output_->error();
  }
}

bool PoseSender::finish() {
  const bool cut = !output_->finish();
  if (dropped_ > 0)
    log::warn("--poses-to {}: {} of {} lines dropped, since nobody took them in time", target_, dropped_,
              lines_);
  if (cut) log::warn("--poses-to {}: the last line is cut, since its reader did not take it all", target_);
  if (failed_ == 0) return true;
  log::error("--poses-to {}: {} of {} lines could not be written ({}); is the disk full?", target_, failed_,
             lines_, std::generic_category().message(error_));
  return false;
}

}  // namespace kinloop
