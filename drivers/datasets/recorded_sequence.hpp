#pragma once
// A recorded sequence as plain data: where the images of each frame are, and what is known about the camera.
// Readers of layouts make it; RecordedSource delivers its frames. No image is decoded to make it.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

class UnpackedArchive;

/// An encoded image: a file, or a part of one.
struct ImageLocation {
  std::filesystem::path file;
  uint64_t offset = 0;
  uint64_t size = 0;  ///< bytes; 0: the whole file
};

/// The images of a frame.
struct RecordedFrame {
  int64_t stamp_ns = 0;        ///< of colour
  int64_t depth_stamp_ns = 0;  ///< of depth
  ImageLocation color;         ///< not used if colour is a video
  ImageLocation depth;
  std::filesystem::path confidence;  ///< of depth, ARKit's levels from 0; empty: unknown
  size_t video_frame = 0;            ///< index in the video
  std::filesystem::path mask = {};   ///< of the colour image, see find_masks; empty: all is used
};

enum class DepthEncoding {
  kImage,       ///< PNG, PGM or one of numbers (see depth_file.hpp), in units of the camera's depth_scale
  kRawUint16,   ///< little-endian, in the same units
  kZlibUint16,  ///< the same, compressed by zlib
  kRawFloat32,  ///< little-endian, in metres
  kFloatImage,  ///< a file of floats in metres: .npy, EXR and others
};

/// Images without a partner.
struct UnpairedImages {
  size_t count = 0;
  size_t of = 0;                ///< all images of this kind
  std::filesystem::path first;  ///< empty if there is none
};

/// How colour and depth images were paired.
struct Pairing {
  std::string rule;   ///< for users: "of equal names"; empty: the files say which belong together
  std::string times;  ///< for users: "names are times in nanoseconds"; empty: nothing to say
  UnpairedImages color, depth;
  bool by_order = false;  ///< nothing tells that the images of a pair belong together
};

struct RecordedSequence {
  std::string layout;                      ///< for users: "7-Scenes"
  std::optional<RgbdCamera> camera;        ///< nullopt if the files do not tell
  std::optional<DepthSensorModel> sensor;  ///< nullopt if the layout does not tell
  std::string camera_remedy;               ///< what is missing if there is no camera
  DepthEncoding depth_encoding = DepthEncoding::kImage;
  std::filesystem::path video;        ///< with the colour images; empty: each is a file
  bool stamps_measured = true;        ///< false: made from the frame rate
  std::vector<RecordedFrame> frames;  ///< in order of time
  SkippedFrames skipped;              ///< listed, but not usable
  Pairing pairing;
  Trajectory ground_truth;      ///< of the colour camera; empty if there is none
  bool truth_in_metres = true;  ///< false: in an arbitrary unit, as COLMAP has
  /// What keeps the files where they are, if they came out of an archive; else null.
  std::shared_ptr<const UnpackedArchive> unpacked;
  std::string depth_unit_guess;  ///< for users: nobody states the unit of depth; empty: it is stated
};

/// Returns whether depth is in metres, whatever the camera's depth_scale.
inline bool is_metric(DepthEncoding encoding) {
  return encoding == DepthEncoding::kRawFloat32 || encoding == DepthEncoding::kFloatImage;
}

/// Returns whether depth images state their size.
inline bool has_header(DepthEncoding encoding) {
  return encoding == DepthEncoding::kImage || encoding == DepthEncoding::kFloatImage;
}

/// Describes the sequence to the user: "7-Scenes: 1000 frames, 640 x 480, registered depth in mm".
std::string describe(const RecordedSequence& sequence, const RgbdCamera& camera);

}  // namespace kinloop
