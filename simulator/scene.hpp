#pragma once
// In: solids, textures and lamps. Out: what a ray meets, its colour, and exact distances to the surface.

#include <vector>

#include "simulator/bvh.hpp"
#include "simulator/lighting.hpp"
#include "simulator/texture.hpp"

namespace kinloop::sim {

/// A furnished room, ready to be looked at. Coordinates: z up, metres.
class Scene {
 public:
  Scene(std::vector<Primitive> primitives, std::vector<Texture> textures, const std::vector<Light>& lights,
        int threads);

  [[nodiscard]] const Bvh& bvh() const { return bvh_; }
  [[nodiscard]] const std::vector<Primitive>& primitives() const { return primitives_; }

  /// Mean colour (BGR, 0 to 255) that the rays of a packet bring back. `pixel_angle` is the width, at
  /// distance 1, that each of them stands for.
  [[nodiscard]] Lanes mean_color(const RayPacket& rays, const HitPacket& hits, float pixel_angle) const;

  /// Cosine between a ray and the surface it hits; 0 where an infrared camera would see nothing there.
  [[nodiscard]] float infrared_cosine(const RayPacket& rays, const HitPacket& hits, int lane) const;

  /// Distance from a point to the nearest surface, unsigned.
  [[nodiscard]] double distance_to_surface(const Eigen::Vector3d& p_room) const;

 private:
  /// How one face is looked up: its texture, and the footprint of a ray in pixels of it.
  struct FaceLookup {
    const FaceTexture* face_texture;
    const Texture* texture;
    float u_span, v_span;  ///< texture widths along the whole face
    float footprint_px;
    bool emissive;
  };
  [[nodiscard]] FaceLookup look_up_face(const Primitive& solid, const SurfacePoint& point, float cosine,
                                        float footprint_m) const;
  [[nodiscard]] Lanes lane_color(const RayPacket& rays, const HitPacket& hits, int lane,
                                 float pixel_angle) const;

  std::vector<Primitive> primitives_;
  std::vector<Texture> textures_;
  Bvh bvh_;
  LightMap light_;
};

}  // namespace kinloop::sim
