#include "viewer/scene/wire_format.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "kinloop/core/text/json.hpp"

namespace kinloop {
namespace {

static_assert(std::endian::native == std::endian::little, "the wire is little-endian");

/// Appends numbers to a buffer.
class Writer {
 public:
  explicit Writer(size_t bytes) { bytes_.reserve(bytes); }

  template <class T>
  void put(T value) {
    const auto* at = reinterpret_cast<const uint8_t*>(&value);
    bytes_.insert(bytes_.end(), at, at + sizeof value);
  }
  void put(const Eigen::Vector3f& v) {
    for (const float x : v) put(x);
  }
  void put(const SE3& pose) {
    put(Eigen::Vector3f(pose.translation.cast<float>()));
    for (const double x : pose.rotation.coeffs()) put(static_cast<float>(x));
  }
  [[nodiscard]] WireBytes take() { return std::move(bytes_); }

 private:
  WireBytes bytes_;
};

constexpr size_t kBytesPerPoint = 12, kBeforePoints = 24;

/// Appends coloured points as described at `encode_cloud`; `fourth(i)` is the fourth number of point i.
template <class Fourth>
void put_points(Writer& body, KeyframeId anchor, std::span<const Eigen::Vector3f> points,
                std::span<const Rgb> colors, const Fourth& fourth) {
  constexpr float kMaxUnits = std::numeric_limits<int16_t>::max();
  constexpr float kFinestM = 1e-4F;
  Eigen::Vector3f low = Eigen::Vector3f::Zero(), high = Eigen::Vector3f::Zero();
  if (!points.empty()) low = high = points.front();
  for (const auto& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector3f origin = (low + high) / 2;
  const float unit_m = std::max(kFinestM, (high - low).maxCoeff() / 2 / kMaxUnits);
  body.put(anchor.value);
  body.put(static_cast<uint32_t>(points.size()));
  body.put(unit_m);
  body.put(origin);
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f units =
        ((points[i] - origin) / unit_m).array().round().max(-kMaxUnits).min(kMaxUnits);
    for (const float x : units) body.put(static_cast<int16_t>(x));
    body.put(fourth(i));
  }
  for (const Rgb& color : colors) {
    for (const uint8_t x : color) body.put(x);
    body.put(uint8_t{0});
  }
}

/// A unit vector by its position on an octahedron that is folded open (Meyer et al. 2010): the first
/// coordinate in the lower byte, the second in the upper one, each in 127ths.
int16_t octahedral(const Eigen::Vector3f& normal) {
  constexpr float kUnits = 127;
  const float length = normal.cwiseAbs().sum();
  if (!(length > 0)) return 0;
  const auto folded = [](float a, float b) { return std::copysign(1 - std::abs(b), a); };
  Eigen::Vector2f p = normal.head<2>() / length;
  if (normal.z() < 0) p = Eigen::Vector2f(folded(p.x(), p.y()), folded(p.y(), p.x()));
  const auto byte = [](float x) { return static_cast<unsigned>(std::lround(kUnits * x)) & 0xFFU; };
  return static_cast<int16_t>(byte(p.x()) | byte(p.y()) << 8);
}

}  // namespace

WireBytes encode_json(const nlohmann::json& json) {
  const std::string text = json_text(json);
  return {text.begin(), text.end()};
}

WireBytes encode_poses(std::span<const SE3> poses) {
  Writer body(poses.size() * 7 * sizeof(float));
  for (const SE3& pose : poses) body.put(pose);
  return body.take();
}

WireBytes encode_path(std::span<const PathPoint> points) {
  Writer body(points.size() * sizeof(PathPoint));
  for (const PathPoint& point : points) {
    body.put(point.reference.value);
    body.put(point.position);
  }
  return body.take();
}

WireBytes encode_ranges(std::span<const FrameRange> ranges) {
  Writer body(ranges.size() * 2 * sizeof(uint32_t));
  for (const auto& [first, end] : ranges) {
    body.put(first);
    body.put(end);
  }
  return body.take();
}

WireBytes encode_pairs(std::span<const std::pair<KeyframeId, KeyframeId>> pairs) {
  Writer body(pairs.size() * 2 * sizeof(uint32_t));
  for (const auto& [a, b] : pairs) {
    body.put(a.value);
    body.put(b.value);
  }
  return body.take();
}

WireBytes encode_points(std::span<const Eigen::Vector3f> points) {
  Writer body(points.size() * sizeof(Eigen::Vector3f));
  for (const auto& point : points) body.put(point);
  return body.take();
}

WireBytes encode_features(std::span<const ShownFeature> features) {
  constexpr float kUnits = std::numeric_limits<uint16_t>::max();
  const auto units = [](float share) {
    return static_cast<uint16_t>(std::lround(kUnits * std::clamp(share, 0.F, 1.F)));
  };
  Writer body(features.size() * 4 * sizeof(uint16_t));
  for (const ShownFeature& feature : features) {
    body.put(units(feature.position.x()));
    body.put(units(feature.position.y()));
    body.put(static_cast<uint16_t>(feature.tracked ? 1 : 0));
    body.put(uint16_t{0});
  }
  return body.take();
}

WireBytes encode_cloud(const CloudPiece& piece) {
  Writer body(kBeforePoints + piece.cloud.size() * kBytesPerPoint);
  put_points(body, piece.anchor, piece.cloud.points, piece.cloud.colors, [](size_t) { return int16_t{0}; });
  return body.take();
}

WireBytes encode_mesh_piece(const MeshPiece& piece) {
  const ColoredMesh& mesh = piece.surface.mesh;
  Writer body(kBeforePoints + mesh.points.size() * kBytesPerPoint +
              mesh.triangles.size() * 3 * sizeof(uint16_t));
  put_points(body, piece.anchor, mesh.points, mesh.colors,
             [&](size_t i) { return octahedral(piece.surface.normals[i]); });
  for (const Triangle& triangle : mesh.triangles) {
    for (const uint32_t corner : triangle) body.put(static_cast<uint16_t>(corner));
  }
  return body.take();
}

WireBytes encode_timeline(std::span<const TimelineFrame> frames) {
  constexpr size_t kBytesPerFrame = 64;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const SE3 nowhere{Eigen::Quaterniond(kNan, kNan, kNan, kNan), Eigen::Vector3d::Constant(kNan)};
  Writer body(frames.size() * kBytesPerFrame);
  for (const TimelineFrame& frame : frames) {
    body.put(frame.stamp_s);
    body.put(frame.status);
    body.put(frame.keyframe.value);
    for (const float figure : {frame.tracked, frame.sigma_m, frame.ms, frame.error_m}) body.put(figure);
    body.put(uint32_t{0});  // aligns the next stamp
    body.put(frame.T_world_camera.value_or(nowhere));
  }
  return body.take();
}

WireBytes encode_mesh(const ColoredMesh& mesh) {
  constexpr size_t kMaxBytesPerVertex = 16;
  Writer body(3 * sizeof(uint32_t) + mesh.points.size() * kMaxBytesPerVertex +
              mesh.triangles.size() * sizeof(Triangle));
  body.put(static_cast<uint32_t>(mesh.points.size()));
  body.put(static_cast<uint32_t>(mesh.triangles.size()));
  body.put(static_cast<uint32_t>(mesh.colors.empty() ? 0 : 1));
  for (const auto& point : mesh.points) body.put(point);
  for (const Triangle& triangle : mesh.triangles) body.put(triangle);
  for (const auto& [red, green, blue] : mesh.colors) body.put(std::array<uint8_t, 4>{red, green, blue, 0});
  return body.take();
}

std::array<uint8_t, kHeaderBytes> encode_header(const MessageHeader& header) {
  Writer bytes(kHeaderBytes);
  bytes.put(static_cast<uint32_t>(header.kind));
  bytes.put(header.index);
  bytes.put(static_cast<double>(header.version));
  bytes.put(static_cast<double>(header.body_bytes));
  bytes.put(static_cast<double>(header.offset_bytes));
  std::array<uint8_t, kHeaderBytes> array{};
  std::ranges::copy(bytes.take(), array.begin());
  return array;
}

}  // namespace kinloop
