#include "tools/export/trajectory_writer.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

/// The upper three rows of each T_world_camera, row by row.
void write_kitti(const std::filesystem::path& path, const Trajectory& trajectory) {
  AtomicFile file(path);
  for (const StampedPose& pose : trajectory) {
    const Eigen::Matrix4d T = pose.T_world_camera.matrix();
    for (int i = 0; i < 12; ++i) fmt::print(file.stream(), "{:.12g}{}", T(i / 4, i % 4), i < 11 ? ' ' : '\n');
  }
  file.commit();
}

}  // namespace

void write_path_csv(const std::filesystem::path& path, const Trajectory& trajectory,
                    const std::string& frame_id) {
  AtomicFile file(path);
  file.stream() << "header.stamp.sec,header.stamp.nanosec,header.frame_id,"
                   "pose.position.x,pose.position.y,pose.position.z,"
                   "pose.orientation.x,pose.orientation.y,pose.orientation.z,pose.orientation.w\n";
  for (const auto& [stamp_ns, T] : trajectory) {
    if (!T.is_finite()) continue;
    const auto& t = T.translation;
    const auto& q = T.rotation;
    const auto [seconds, nanoseconds] = split_stamp(stamp_ns);
    fmt::print(file.stream(), "{},{},{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n", seconds,
               nanoseconds, frame_id, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  file.commit();
}

bool is_kitti_name(const std::filesystem::path& path) {
  return path.extension() == ".kitti";
}

void require_pose_of_each_frame(const std::filesystem::path& path, size_t poses, size_t frames) {
  if (!is_kitti_name(path) || poses == frames) return;
  throw InputError(
      fmt::format("{}: KITTI format has a line for each frame, but {} of {} frames have no pose; give a name "
                  "that ends in .txt (TUM format) or .csv",
                  path.string(), frames - poses, frames));
}

void write_trajectory_file(const std::filesystem::path& path, const Trajectory& trajectory,
                           const std::string& note) {
  if (path.extension() == ".csv") return write_path_csv(path, trajectory, "world");
  if (is_kitti_name(path)) return write_kitti(path, trajectory);
  write_tum_trajectory(path, trajectory, note);
}

}  // namespace kinloop
