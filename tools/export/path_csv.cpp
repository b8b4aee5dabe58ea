#include "tools/export/path_csv.hpp"

#include <fmt/ostream.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {

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

}  // namespace kinloop
