#include <algorithm>
#include <limits>

#include "tools/export/mcap/mcap_writer.hpp"
#include "tools/export/mcap/messages.hpp"
#include "tools/export/mcap/recording.hpp"

namespace kinloop {
namespace {

constexpr const char* kMapFrame = "map";
constexpr const char* kCameraFrame = "camera";

class RecordingWriter {
 public:
  RecordingWriter(const std::filesystem::path& path, const MapRecording& recording)
      : recording_(recording),
        file_(path),
        transforms_(file_.add_topic(foxglove::frame_transform_topic("/tf"))),
        poses_(file_.add_topic(foxglove::pose_topic("/pose"))),
        clouds_(file_.add_topic(foxglove::point_cloud_topic("/cloud"))),
        images_(file_.add_topic(foxglove::image_topic("/camera/image"))),
        calibrations_(file_.add_topic(foxglove::calibration_topic("/camera/calibration"))) {}

  void write_pose(const StampedPose& stamped) {
    const auto& [stamp_ns, T_world_camera] = stamped;
    if (!T_world_camera.is_finite()) return;
    const SE3 T_map_camera = recording_.frame.T_file_world() * T_world_camera;
    file_.write(transforms_, stamp_ns,
                foxglove::frame_transform(stamp_ns, kMapFrame, kCameraFrame, T_map_camera));
    file_.write(poses_, stamp_ns, foxglove::pose(stamp_ns, kMapFrame, T_map_camera));
  }

  void write_image(int64_t stamp_ns, const std::vector<uint8_t>& jpeg) {
    const std::string_view bytes(reinterpret_cast<const char*>(jpeg.data()), jpeg.size());
    file_.write(calibrations_, stamp_ns, foxglove::calibration(stamp_ns, kCameraFrame, recording_.camera));
    file_.write(images_, stamp_ns, foxglove::jpeg_image(stamp_ns, kCameraFrame, bytes));
  }

  void write_cloud(int64_t stamp_ns) {
    if (recording_.cloud.size() == 0) return;
    file_.write(clouds_, stamp_ns,
                foxglove::point_cloud(stamp_ns, kMapFrame, recording_.cloud, recording_.frame));
  }

  void commit() { file_.commit(); }

 private:
  const MapRecording& recording_;
  McapWriter file_;
  uint16_t transforms_, poses_, clouds_, images_, calibrations_;
};

}  // namespace

void write_map_recording(const std::filesystem::path& path, const MapRecording& recording,
                         const JpegLoader& load_jpeg) {
  constexpr int64_t kLast = std::numeric_limits<int64_t>::max();
  const Trajectory& trajectory = recording.trajectory;
  const std::vector<StampedImage>& images = recording.images;
  RecordingWriter writer(path, recording);
  size_t next_pose = 0, next_image = 0;
  const auto pose_stamp = [&] {
    return next_pose < trajectory.size() ? trajectory[next_pose].stamp_ns : kLast;
  };
  const auto image_stamp = [&] { return next_image < images.size() ? images[next_image].stamp_ns : kLast; };
  const int64_t first_ns = std::min(pose_stamp(), image_stamp());
  writer.write_cloud(first_ns == kLast ? 0 : first_ns);
  while (next_pose < trajectory.size() || next_image < images.size()) {
    if (next_pose < trajectory.size() && pose_stamp() <= image_stamp()) {
      writer.write_pose(trajectory[next_pose++]);
    } else {
      writer.write_image(image_stamp(), load_jpeg(images[next_image].image));
      ++next_image;
    }
  }
  writer.commit();
}

}  // namespace kinloop
