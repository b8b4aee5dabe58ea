#pragma once
// The protocol between server and browser. A part of the scene is a header of 32 bytes and a body; all
// numbers little-endian, every array aligned to its elements, so that a page can read them in place. Every
// message is one binary WebSocket frame: the header, then the next piece of the body, most often all of it.
//
//   header   u32 kind, u32 index (which part of that kind), f64 version (see scene.hpp),
//            f64 bytes of the body, f64 offset of the piece in the body
//
// viewer/pages/src/viewer/messages.js is the counterpart of this file.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "dense/live_mesh/live_mesh.hpp"
#include "dense/mesh/colored_mesh.hpp"
#include "kinloop/core/ids.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

using WireBytes = std::vector<uint8_t>;

/// The kind of a message, with the content of its body.
enum class PartKind : uint32_t {
  kHello = 0,           ///< JSON: properties of the scene; sent first to every browser
  kStatus = 1,          ///< JSON: state of the run
  kCamera = 2,          ///< one pose: the camera's current one
  kKeyframes = 3,       ///< poses of kPartLength keyframes, part i from keyframe i * kPartLength on
  kPath = 4,            ///< kPartLength frames: u32 reference keyframe, 3 f32 position in its camera frame
  kCovisibility = 5,    ///< kPartLength pairs of u32: keyframes that share landmarks
  kLoops = 6,           ///< pairs of u32: keyframes connected by a loop edge
  kCloud = 7,           ///< a piece of the cloud, see `encode_cloud`
  kColorImage = 8,      ///< a JPEG file
  kDepthImage = 9,      ///< a JPEG file, depth as colours
  kFeatures = 10,       ///< per keypoint of the colour image: u16 x, u16 y, u16 tracked (0 or 1), u16 0
  kTruth = 11,          ///< 3 f32 each: the ground truth path, in its own world
  kTruthPose = 12,      ///< one pose: of that world in the map's
  kMesh = 13,           ///< see `encode_mesh`; 0: all of it, 1: a coarse one that stands in for it
  kModel = 14,          ///< a GLB file
  kDoubt = 15,          ///< ranges of the path's frames, u32 first and u32 end, that are doubtful or lost
  kKeyframeImage = 16,  ///< a small JPEG file: the colour image of the keyframe `index`
  kTimeline = 17,       ///< all frames of a saved run, or of two (0 and 1), see `encode_timeline`
  kLoopTable = 18,      ///< JSON: the loops of a saved run, accepted or not, and the file of its map
  kComparison = 19,     ///< JSON: what differs between two maps, and which cloud pieces show it
  kOtherPath = 20,      ///< 3 f32 each: the path of the second of two compared maps
  kTruthErrors = 21,    ///< 6 f32 each: estimated and true position of a keyframe or frame, in the world
  kMeshPiece = 22,      ///< a piece of the live mesh, see `encode_mesh_piece`
};

/// Number of keyframes, or frames, per part, the unit of updates.
constexpr uint32_t kPartLength = 64;

constexpr size_t kHeaderBytes = 32;

/// A point of the path, relative to a keyframe, so that it follows corrections of the map.
struct PathPoint {
  KeyframeId reference;      ///< invalid: `position` is in the world frame
  Eigen::Vector3f position;  ///< NaN where tracking was lost
};

/// A piece of the cloud, in the camera frame of its anchor keyframe or in the world frame.
struct CloudPiece {
  KeyframeId anchor;  ///< invalid: in the world frame
  ColoredCloud cloud;
};

/// A keypoint of the colour image, as a fraction of its width and height, and whether it matches a landmark.
struct ShownFeature {
  Eigen::Vector2f position;
  bool tracked = false;
};

// Bodies.

WireBytes encode_json(const nlohmann::json& json);

/// 7 f32: translation, then the quaternion x, y, z, w.
WireBytes encode_poses(std::span<const SE3> poses);

WireBytes encode_path(std::span<const PathPoint> points);

WireBytes encode_pairs(std::span<const std::pair<KeyframeId, KeyframeId>> pairs);

/// A range of frames [first, end).
using FrameRange = std::pair<uint32_t, uint32_t>;

WireBytes encode_ranges(std::span<const FrameRange> ranges);

/// Returns the ranges of indices below `count` for which `is_member(index)` holds.
template <class IsMember>
std::vector<FrameRange> ranges_where(size_t count, const IsMember& is_member) {
  std::vector<FrameRange> ranges;
  for (uint32_t i = 0; i < count; ++i) {
    if (!is_member(i)) continue;
    if (ranges.empty() || ranges.back().second != i) ranges.emplace_back(i, i);
    ++ranges.back().second;
  }
  return ranges;
}

WireBytes encode_points(std::span<const Eigen::Vector3f> points);

WireBytes encode_features(std::span<const ShownFeature> features);

/// u32 anchor (all bits set: the world), u32 n, f32 metres per unit, 3 f32 origin; n times 4 i16 (x, y, z in
/// units from the origin, 0), n times 4 u8 (red, green, blue, 0). The unit is chosen so that the piece fits:
/// a tenth of a millimetre for the view of a single camera.
WireBytes encode_cloud(const CloudPiece& piece);

enum class FrameStatus : uint32_t { kTracked = 0, kDoubtful = 1, kLost = 2 };

/// A frame of a saved run; figures are 0 if unknown.
struct TimelineFrame {
  double stamp_s = 0;
  FrameStatus status = FrameStatus::kTracked;
  KeyframeId keyframe;  ///< that was made of this frame; invalid: none
  float tracked = 0;    ///< keypoints matched to landmarks
  float sigma_m = 0;    ///< of the position
  float ms = 0;         ///< wall time
  float error_m = 0;    ///< distance from the true position, paths aligned
  std::optional<SE3> T_world_camera;
};

/// For each frame, in the order of stamps: f64 stamp, s; u32 status (0 tracked, 1 doubtful, 2 lost); u32
/// keyframe (all bits set: none); f32 tracked, sigma_m, ms, error_m; u32 0; 7 f32 pose as in `encode_poses`,
/// NaN if it has none.
WireBytes encode_timeline(std::span<const TimelineFrame> frames);

/// As `encode_cloud`, of the vertices, with the normal of each in place of the fourth i16 (its octahedral
/// coordinates: i8 first, then second, in 127ths); then 3 u16 (vertex indices) per triangle.
WireBytes encode_mesh_piece(const MeshPiece& piece);

/// u32 n vertices, u32 m triangles, u32 whether there are colours; n times 3 f32 (x, y, z in the world), m
/// times 3 u32 (vertex indices), n times 4 u8 (red, green, blue, 0) if there are colours.
WireBytes encode_mesh(const ColoredMesh& mesh);

/// Identity and size of a part, and where a message's piece of it begins.
struct MessageHeader {
  PartKind kind = PartKind::kHello;
  uint32_t index = 0;
  uint64_t version = 0;
  size_t body_bytes = 0;
  size_t offset_bytes = 0;
};

std::array<uint8_t, kHeaderBytes> encode_header(const MessageHeader& header);

}  // namespace kinloop
