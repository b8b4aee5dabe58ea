// 7-Scenes (Shotton et al. 2013): frame-000000.color.png, .depth.png in millimetres and .pose.txt of the
// depth camera. Depth is not registered to colour. The same names are used with a camera-intrinsics.txt in
// the folder or above it by datasets with registered depth (3DMatch).

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "drivers/datasets/camera_files/find_camera.hpp"
#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/images/depth_image.hpp"
#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/datasets/reading/lists/frame_files.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "drivers/image_files/image_file.hpp"
#include "drivers/probe/sequence_statistics.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/sensor/camera/registration.hpp"

namespace kinloop {
namespace {

constexpr const char* kIntrinsicsName = "camera-intrinsics.txt";
const cv::Size kImageSize(640, 480);

std::string seven_scenes_evidence(const std::filesystem::path&, const FolderContents& contents) {
  return frame_files_evidence(contents);
}

/// The dataset has no calibration of colour; this is the one of docs/recordings.md, checked on RedKitchen.
RgbdCamera seven_scenes_camera() {
  RgbdCamera camera;
  camera.depth_scale = 1000;
  camera.color = make_lens(kImageSize, 522.07, 522.07, 319.07, 237.69);
  camera.depth = make_lens(kImageSize, 585, 585, 320, 240);
  camera.T_color_depth = {exp_so3({-0.0007, 0.0002, 0.0012}), {-0.0239, 0.0027, -0.0049}};
  return camera;
}

/// Returns camera-intrinsics.txt in the folder or above it, if there is one.
std::optional<std::filesystem::path> intrinsics_file(const std::filesystem::path& folder) {
  for (const auto& file :
       {folder / kIntrinsicsName, folder.lexically_normal().parent_path() / kIntrinsicsName}) {
    std::error_code absent;
    if (std::filesystem::exists(file, absent)) return file;
  }
  return std::nullopt;
}

/// The camera in camera-intrinsics.txt; nullopt if there is none, or it is that of the original depth.
std::optional<RgbdCamera> registered_camera(const std::filesystem::path& folder, cv::Size size) {
  const auto file = intrinsics_file(folder);
  if (!file) return std::nullopt;
  RgbdCamera camera;
  camera.depth_scale = 1000;
  camera.color = read_lens(*file, size);
  const bool of_depth = camera.color == *seven_scenes_camera().depth;
  return of_depth ? std::nullopt : std::optional(camera);
}

/// Whether a file of another name beside the images has a camera, which is not the one of the dataset.
bool has_another_camera(const std::filesystem::path& folder) {
  return !intrinsics_file(folder) && find_camera(folder, folder).has_value();
}

/// Frames spread over the sequence, with depth as it is in the files.
std::vector<Frame> some_frames(const RecordedSequence& sequence) {
  constexpr size_t kFrames = 10;
  std::vector<Frame> frames;
  const size_t step = std::max<size_t>(1, sequence.frames.size() / kFrames);
  for (size_t i = 0; i < sequence.frames.size() && frames.size() < kFrames; i += step) {
    const RecordedFrame& files = sequence.frames[i];
    try {
      Frame frame;
      frame.color = read_color_image(files.color.file);
      frame.depth_m = decode_depth(read_bytes(files.depth), files.depth.file, DepthEncoding::kImage,
                                   kImageSize, seven_scenes_camera().depth_scale);
      if (frame.color.size() == kImageSize && frame.depth_m.size() == kImageSize) frames.push_back(frame);
    } catch (const InputError&) {
      continue;  // damaged; the run counts it
    }
  }
  return frames;
}

/// How clearly edges of depth lie on edges of colour; 0 if they lie beside them.
double edge_contrast(const std::vector<Frame>& frames) {
  constexpr double kOnEdges_px = 3;
  const auto found = misregistration(frames);
  return found && found->shift_px.norm() < kOnEdges_px ? found->contrast : 0;
}

/// Whose images have these names: those of the dataset have depth that is not registered.
enum class Owner { kUnknown, kSevenScenes, kAnother };

Owner owner_of(const RecordedSequence& sequence) {
  constexpr double kClearly = 1.1;
  std::vector<Frame> frames = some_frames(sequence);
  const double as_it_is = edge_contrast(frames);
  const DepthRegistration register_depth(seven_scenes_camera());
  for (Frame& frame : frames) frame.depth_m = register_depth(frame.depth_m);
  const double registered = edge_contrast(frames);
  if (as_it_is > kClearly * registered) return Owner::kAnother;
  return registered > kClearly * as_it_is ? Owner::kSevenScenes : Owner::kUnknown;
}

/// A layout's name is no proof of a camera: it is used where edges agree with it, or nothing contradicts it.
/// Returns whether it is used.
bool take_seven_scenes_camera(const std::filesystem::path& folder, RecordedSequence& sequence) {
  const Owner owner = owner_of(sequence);
  if (owner == Owner::kAnother) {
    sequence.layout = "folder of frame-000000.color images";
    sequence.camera_remedy =
        "the names are those of 7-Scenes, but depth is registered to colour already, so that the camera is "
        "another: add a camera.yaml";
    return false;
  }
  sequence.camera = seven_scenes_camera();
  if (owner == Owner::kSevenScenes) {
    log::info("{}: camera of 7-Scenes, with which edges of depth and colour agree", folder.string());
  } else {
    log::warn(
        "{}: the camera of 7-Scenes is assumed, by the names of the files alone; give another with --camera",
        folder.string());
  }
  return true;
}

RecordedSequence read_seven_scenes(const std::filesystem::path& folder) {
  RecordedSequence sequence = read_frame_files(folder);
  sequence.layout = "7-Scenes folder";
  const cv::Size size = image_size(sequence.frames, &RecordedFrame::color);
  if (const auto camera = registered_camera(folder, size)) {
    sequence.camera = camera;
    sequence.layout = "3DMatch folder";
  } else if (size != kImageSize || has_another_camera(folder)) {
    sequence.layout =
        "folder of frame-000000.color images";  // of another camera, whose file may lie beside them
    return sequence;
  } else if (!take_seven_scenes_camera(folder, sequence)) {
    return sequence;
  }
  sequence.sensor = DepthSensorModel::kKinect1;
  if (!sequence.camera->depth) return sequence;
  const SE3 T_depth_color = sequence.camera->T_color_depth.inverse();
  for (StampedPose& pose : sequence.ground_truth) pose.T_world_camera = pose.T_world_camera * T_depth_color;
  return sequence;
}

}  // namespace

SequenceLayout seven_scenes_layout() {
  return {"7-Scenes", "frame-000000.color.png and frame-000000.depth.png", seven_scenes_evidence,
          read_seven_scenes};
}

}  // namespace kinloop
