#include "simulator/render/lighting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop::sim {
namespace {

constexpr float kSpacing_m = 0.09F;    // of grid points
constexpr int kMaxPoints = 96;         // along one side of a face
constexpr int kMinRoundPoints = 7;     // around a cylinder or sphere
constexpr float kRayOffset_m = 0.02F;  // offset of ray origins from the surface: past pictures, into clutter
constexpr float kReach_m = 1.3F;       // range of ambient occlusion
constexpr float kAmbient[3] = {0.44F, 0.42F, 0.41F};
constexpr int kAmbientPackets = 8;
constexpr int kLightPackets = 4;  // packets of kLanes rays to each light
constexpr float kGamma = 1.0F / 2.2F;

/// The rays of a packet share their origin.
RayPacket packet(const Eigen::Vector3f& origin, const std::array<Eigen::Vector3f, kLanes>& d) {
  const auto gather = [&](int axis) { return Lanes{d[0][axis], d[1][axis], d[2][axis], d[3][axis]}; };
  return {{all_lanes(origin.x()), all_lanes(origin.y()), all_lanes(origin.z())},
          {gather(0), gather(1), gather(2)}};
}

/// Cosine-weighted open fraction of the half space above a surface; farther hits occlude less.
float openness(const Bvh& bvh, const Eigen::Vector3f& origin, const Eigen::Vector3f& normal) {
  const Eigen::Vector3f side = normal.unitOrthogonal(), other = normal.cross(side);
  constexpr int kRays = kAmbientPackets * kLanes;
  constexpr float kGoldenTurn = 2.39996323F;
  float closed = 0;
  for (int first = 0; first < kRays; first += kLanes) {
    std::array<Eigen::Vector3f, kLanes> directions;
    for (int lane = 0; lane < kLanes; ++lane) {  // spiral of evenly spread directions
      const float s = (static_cast<float>(first + lane) + 0.5F) / kRays;
      const float turn = kGoldenTurn * static_cast<float>(first + lane);
      const Eigen::Vector3f flat = std::cos(turn) * side + std::sin(turn) * other;
      directions[static_cast<size_t>(lane)] = std::sqrt(s) * flat + std::sqrt(1 - s) * normal;
    }
    const Lanes t = bvh.nearest(packet(origin, directions), kReach_m).t;
    for (int lane = 0; lane < kLanes; ++lane) closed += 1 - t[lane] / kReach_m;
  }
  return 1 - closed / kRays;
}

/// Lambert's cosine times falloff times the visible fraction of a light.
float exposure(const Bvh& bvh, const Eigen::Vector3f& origin, const Eigen::Vector3f& normal,
               const Light& light) {
  float sum = 0;
  constexpr int kSamples = kLightPackets * kLanes;
  for (int first = 0; first < kSamples; first += kLanes) {
    std::array<Eigen::Vector3f, kLanes> to_light;
    Lanes cosine{};
    for (int lane = 0; lane < kLanes; ++lane) {
      const int column = lane, row = first / kLanes;
      const float u = (static_cast<float>(column) + 0.5F) * 2 / kLanes - 1;
      const float v = (static_cast<float>(row) + 0.5F) * 2 / kLightPackets - 1;
      const auto i = static_cast<size_t>(lane);
      to_light[i] = light.center + u * light.half_u + v * light.half_v - origin;
      cosine[lane] = to_light[i].normalized().dot(normal);
    }
    if (!any(cosine > 0)) continue;  // the surface faces away: nothing needs to be traced
    const LaneMask blocker = bvh.nearest(packet(origin, to_light), 1.0F).primitive;
    for (int lane = 0; lane < kLanes; ++lane) {
      const Eigen::Vector3f& ray = to_light[static_cast<size_t>(lane)];
      // 1 + d^2 keeps the light finite next to the lamp.
      if (blocker[lane] < 0 && cosine[lane] > 0) sum += cosine[lane] * 2 / (1 + ray.squaredNorm());
    }
  }
  return sum / kSamples;
}

Lanes brightness(const Primitive& primitive, const Bvh& bvh, const std::vector<Light>& lights, int face,
                 float u, float v) {
  const SurfaceFrame frame = surface_frame(primitive, face, u, v);
  const Eigen::Vector3f normal = primitive.R_room_local * frame.normal_local;
  const Eigen::Vector3f origin =
      primitive.R_room_local * frame.p_local + primitive.center + kRayOffset_m * normal;
  const float open = openness(bvh, origin, normal);
  Eigen::Vector3f sum(kAmbient[0] * open, kAmbient[1] * open, kAmbient[2] * open);
  for (const Light& light : lights) sum += exposure(bvh, origin, normal, light) * light.bgr;
  return Lanes{std::pow(sum.x(), kGamma), std::pow(sum.y(), kGamma), std::pow(sum.z(), kGamma), 0};
}

int points_along(float size_m, bool round) {
  const int points = 2 + static_cast<int>(size_m / kSpacing_m);
  return std::clamp(points, round ? kMinRoundPoints : 2, kMaxPoints);
}

/// Grid points lie slightly inside the face, off the seams with its neighbours.
float inset(int index, int count) {
  constexpr float kInset = 0.02F;
  return kInset + (1 - 2 * kInset) * static_cast<float>(index) / static_cast<float>(count - 1);
}

}  // namespace

LightMap::LightMap(const std::vector<Primitive>& primitives, const Bvh& bvh, const std::vector<Light>& lights,
                   int threads)
    : grids_(primitives.size() * kFaces) {
  uint32_t count = 0;
  struct Row {
    size_t grid;
    int row;
  };
  std::vector<Row> rows;
  for (size_t i = 0; i < grids_.size(); ++i) {
    const Primitive& primitive = primitives[i / kFaces];
    const Eigen::Vector2f size = face_size_m(primitive, static_cast<int>(i % kFaces));
    if (size.isZero()) continue;
    const bool round = primitive.shape != Shape::kBox && i % kFaces == 0;
    const int columns = points_along(size.x(), round);
    grids_[i] = {count, columns, points_along(size.y(), round && primitive.shape == Shape::kSphere)};
    for (int row = 0; row < grids_[i].rows; ++row) rows.push_back({i, row});
    count += static_cast<uint32_t>(columns * grids_[i].rows);
  }
  values_.resize(count);
  parallel_for(rows.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Grid& grid = grids_[rows[i].grid];
      const float v = inset(rows[i].row, grid.rows);
      Lanes* values = values_.data() + grid.first + rows[i].row * grid.columns;
      for (int column = 0; column < grid.columns; ++column) {
        values[column] = brightness(primitives[rows[i].grid / kFaces], bvh, lights,
                                    static_cast<int>(rows[i].grid % kFaces), inset(column, grid.columns), v);
      }
    }
  });
}

Lanes LightMap::at(int primitive, const SurfacePoint& point) const {
  const Grid& grid = grids_[static_cast<size_t>(primitive) * kFaces + static_cast<size_t>(point.face)];
  const float x = std::clamp(point.u, 0.0F, 1.0F) * static_cast<float>(grid.columns - 1);
  const float y = std::clamp(point.v, 0.0F, 1.0F) * static_cast<float>(grid.rows - 1);
  const int x0 = std::min(static_cast<int>(x), grid.columns - 2);
  const int y0 = std::min(static_cast<int>(y), grid.rows - 2);
  const float ax = x - static_cast<float>(x0), ay = y - static_cast<float>(y0);
  const Lanes* upper = values_.data() + grid.first + y0 * grid.columns + x0;
  const Lanes* lower = upper + grid.columns;
  const Lanes top = upper[0] + ax * (upper[1] - upper[0]);
  const Lanes bottom = lower[0] + ax * (lower[1] - lower[0]);
  return top + ay * (bottom - top);
}

Lanes open_brightness(const std::vector<Light>& lights, const Eigen::Vector3f& point,
                      const Eigen::Vector3f& normal) {
  constexpr float kOpenSide = 0.62F, kOpenChange = 0.22F;  // open share beside, and more of it above
  const float open = kOpenSide + kOpenChange * normal.z();
  Eigen::Vector3f sum(kAmbient[0] * open, kAmbient[1] * open, kAmbient[2] * open);
  for (const Light& light : lights) {
    const Eigen::Vector3f ray = light.center - point;
    const float cosine = ray.normalized().dot(normal);
    if (cosine > 0) sum += cosine * 2 / (1 + ray.squaredNorm()) * light.bgr;
  }
  return Lanes{std::pow(sum.x(), kGamma), std::pow(sum.y(), kGamma), std::pow(sum.z(), kGamma), 0};
}

}  // namespace kinloop::sim
