#pragma once
// In: the solids of a scene. Out: the first hit of each ray of a packet.

#include <cstdint>
#include <vector>

#include "simulator/render/lanes.hpp"
#include "simulator/render/primitive.hpp"

namespace kinloop::sim {

/// One ray of a packet at its hit.
struct LaneRay {
  Eigen::Vector3f point, direction;
};

inline LaneRay lane_ray(const RayPacket& rays, Lanes t, int lane) {
  const Eigen::Vector3f d(rays.direction.x[lane], rays.direction.y[lane], rays.direction.z[lane]);
  const Eigen::Vector3f o(rays.origin.x[lane], rays.origin.y[lane], rays.origin.z[lane]);
  return {o + t[lane] * d, d};
}

/// Bounds of the origins and directions of many similar rays.
struct RayBundle {
  Lanes3 origin_low = all_lanes3(kFar), origin_high = all_lanes3(-kFar);  ///< lane by lane
  Lanes3 direction_low = all_lanes3(kFar), direction_high = all_lanes3(-kFar);

  void extend(const RayPacket& rays) {
    origin_low = min(origin_low, rays.origin);
    origin_high = max(origin_high, rays.origin);
    direction_low = min(direction_low, rays.direction);
    direction_high = max(direction_high, rays.direction);
  }

  static constexpr float kFar = 1e30F;
};

/// A primitive that a bundle may hit, from `min_t` on.
struct Candidate {
  float min_t;
  int32_t solid;
};

/// Bounding volume hierarchy of boxes (surface area heuristic of Goldsmith and Salmon 1987).
class Bvh {
 public:
  Bvh() = default;
  explicit Bvh(const std::vector<Primitive>& primitives);

  /// Returns the first hit of every ray with `kMinT` < t < `max_t`.
  [[nodiscard]] HitPacket nearest(const RayPacket& rays, float max_t) const;

  /// Returns the primitives that any ray of the bundle may hit, sorted by least possible t.
  [[nodiscard]] std::vector<Candidate> candidates(const RayBundle& bundle) const;

  /// Same for rays of the bundle, given its candidates.
  [[nodiscard]] HitPacket nearest(const RayPacket& rays, float max_t,
                                  const std::vector<Candidate>& candidates) const;

  static constexpr float kMinT = 1e-4F;

 private:
  struct Node {
    float low[3], high[3];
    int32_t first = 0;  ///< first solid of a leaf, else the right child (the left one follows the node)
    int32_t count = 0;  ///< solids of a leaf, 0 for an inner node
    int32_t axis = 0;   ///< by which the children are ordered
  };
  /// The data of a primitive for the ray test, packed.
  struct Solid {
    float R_local_room[9];
    float center[3], half[3];
    Shape shape;
    bool aligned;  ///< an axis-aligned box; its half extents are in the room frame
    int32_t primitive;
  };

  static Solid packed(const Primitive& primitive, int32_t index);
  int32_t build(std::vector<int32_t>& order, size_t begin, size_t end,
                const std::vector<Eigen::AlignedBox3f>& boxes, const std::vector<Primitive>& primitives,
                int depth);
  static void intersect(const Solid& solid, const RayPacket& rays, const Lanes3& inverse, HitPacket& hits);

  std::vector<Node> nodes_;
  std::vector<Solid> solids_;  ///< in the order of the leaves
};

}  // namespace kinloop::sim
