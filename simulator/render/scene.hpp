#pragma once
// In: solids, textures, lamps and what moves. Out: what a moment (moment.hpp) is rendered from, and exact
// distances to the surface.

#include <vector>

#include "simulator/movers/movers.hpp"
#include "simulator/paint/texture.hpp"
#include "simulator/render/bvh.hpp"
#include "simulator/render/lighting.hpp"

namespace kinloop::sim {

/// A furnished room ready for rendering. Coordinates: z up, metres.
class Scene {
 public:
  Scene(std::vector<Primitive> primitives, std::vector<Texture> textures, std::vector<Light> lights,
        int threads, Movers movers = {});

  [[nodiscard]] const Bvh& bvh() const { return bvh_; }  ///< of what does not move
  [[nodiscard]] const std::vector<Primitive>& primitives() const { return primitives_; }
  [[nodiscard]] const std::vector<Texture>& textures() const { return textures_; }
  [[nodiscard]] const std::vector<Light>& lights() const { return lights_; }
  [[nodiscard]] const LightMap& light_map() const { return light_map_; }
  [[nodiscard]] const Movers& movers() const { return movers_; }

  /// Returns the unsigned distance from a point to the nearest surface that does not move.
  [[nodiscard]] double distance_to_surface(const Eigen::Vector3d& p_room) const;

 private:
  std::vector<Primitive> primitives_;
  std::vector<Texture> textures_;
  std::vector<Light> lights_;
  Movers movers_;
  Bvh bvh_;
  LightMap light_map_;
};

}  // namespace kinloop::sim
