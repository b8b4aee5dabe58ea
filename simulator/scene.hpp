#pragma once
// In: solids, textures and lamps. Out: ray hits, their colour, and exact distances to the surface.

#include <vector>

#include "simulator/bvh.hpp"
#include "simulator/lighting.hpp"
#include "simulator/texture.hpp"

namespace kinloop::sim {

/// A furnished room ready for rendering. Coordinates: z up, metres.
class Scene {
 public:
  Scene(std::vector<Primitive> primitives, std::vector<Texture> textures, const std::vector<Light>& lights,
        int threads);

  [[nodiscard]] const Bvh& bvh() const { return bvh_; }
  [[nodiscard]] const std::vector<Primitive>& primitives() const { return primitives_; }

  /// Returns the mean colour (BGR, 0 to 255) of the rays of a packet. `pixel_angle` is the width, at distance
  /// 1, that each of them represents.
  [[nodiscard]] Lanes mean_color(const RayPacket& rays, const HitPacket& hits, float pixel_angle) const;

  /// Returns the cosine of the incidence angle; 0 if the surface returns no infrared light.
  [[nodiscard]] float infrared_cosine(const RayPacket& rays, const HitPacket& hits, int lane) const;

  /// Returns the share of infrared light that the surface reflects. `pixel_angle` as above.
  [[nodiscard]] float infrared_reflectance(const RayPacket& rays, const HitPacket& hits, int lane,
                                           float pixel_angle) const;

  /// Returns the unsigned distance from a point to the nearest surface.
  [[nodiscard]] double distance_to_surface(const Eigen::Vector3d& p_room) const;

 private:
  /// Lookup data of one face: its texture, and the footprint of a ray in texture pixels.
  struct FaceLookup {
    const FaceTexture* face_texture;
    const Texture* texture;
    float u_span, v_span;  ///< texture widths along the whole face
    float footprint_px;
    bool emissive;
  };
  /// A point of a surface and its colour in white light.
  struct SurfaceLook {
    SurfacePoint point;
    Lanes albedo;
    bool emissive;
  };
  [[nodiscard]] FaceLookup look_up_face(const Primitive& solid, const SurfacePoint& point, float cosine,
                                        float footprint_m) const;
  [[nodiscard]] SurfaceLook look_at(const RayPacket& rays, const HitPacket& hits, int lane,
                                    float pixel_angle) const;
  [[nodiscard]] Lanes lane_color(const RayPacket& rays, const HitPacket& hits, int lane,
                                 float pixel_angle) const;

  std::vector<Primitive> primitives_;
  std::vector<Texture> textures_;
  Bvh bvh_;
  LightMap light_;
};

}  // namespace kinloop::sim
