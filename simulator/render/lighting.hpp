#pragma once
// In: solids and lamps. Out: the brightness of every surface, precomputed so that rendering needs no shadow
// rays.

#include <vector>

#include "simulator/render/bvh.hpp"

namespace kinloop::sim {

/// A rectangular light source.
struct Light {
  Eigen::Vector3f center, half_u, half_v;  ///< room frame, metres
  Eigen::Vector3f bgr;                     ///< brightness at 1 m
};

/// Brightness on a grid over every face: ambient light with occlusion, and lamps with soft shadows.
class LightMap {
 public:
  LightMap() = default;
  LightMap(const std::vector<Primitive>& primitives, const Bvh& bvh, const std::vector<Light>& lights,
           int threads);

  /// Returns BGR factors for a surface point.
  [[nodiscard]] Lanes at(int primitive, const SurfacePoint& point) const;

 private:
  struct Grid {
    uint32_t first = 0;
    int32_t columns = 0, rows = 0;
  };
  std::vector<Grid> grids_;  ///< kFaces for every primitive
  std::vector<Lanes> values_;
};

/// Returns BGR factors for a point in the open with a normal: no shadows, and less ambient light from below.
Lanes open_brightness(const std::vector<Light>& lights, const Eigen::Vector3f& point,
                      const Eigen::Vector3f& normal);

}  // namespace kinloop::sim
