#pragma once
// In: a scene and a time. Out: ray hits and their colour, with everything that moves where it is then.

#include <cstdint>
#include <vector>

#include "simulator/render/scene.hpp"

namespace kinloop::sim {

/// What a solid does.
enum class Motion { kNone, kAtRest, kMoving };  ///< part of the room, a mover that rests now, or that moves

/// What the rays of a bundle may hit.
struct MomentCandidates {
  std::vector<Candidate> fixed, movers;
};

/// A scene at one time. Refers to the scene. Primitives are counted through: first those of the scene, then
/// those of the movers.
class Moment {
 public:
  Moment(const Scene& scene, int64_t stamp_ns);

  /// Returns what the rays of a bundle may hit.
  [[nodiscard]] MomentCandidates candidates(const RayBundle& bundle) const {
    return {scene_->bvh().candidates(bundle), mover_candidates(bundle)};
  }
  [[nodiscard]] std::vector<Candidate> mover_candidates(const RayBundle& bundle) const {
    return bvh_.candidates(bundle);
  }

  /// Returns the first hit of every ray, as the methods of Bvh do.
  [[nodiscard]] HitPacket nearest(const RayPacket& rays, float max_t) const;
  [[nodiscard]] HitPacket nearest(const RayPacket& rays, float max_t,
                                  const MomentCandidates& candidates) const;

  [[nodiscard]] const Primitive& primitive(int index) const;
  [[nodiscard]] Motion motion_of(int primitive) const;  ///< kNone for -1

  /// Returns the mean colour (BGR, 0 to 255) of the rays of a packet. `pixel_angle` is the width, at distance
  /// 1, that each of them represents.
  [[nodiscard]] Lanes mean_color(const RayPacket& rays, const HitPacket& hits, float pixel_angle) const;

  /// Returns the cosine of the incidence angle; 0 if the surface returns no infrared light.
  [[nodiscard]] float infrared_cosine(const RayPacket& rays, const HitPacket& hits, int lane) const;

  /// Returns the share of infrared light that the surface reflects. `pixel_angle` as above.
  [[nodiscard]] float infrared_reflectance(const RayPacket& rays, const HitPacket& hits, int lane,
                                           float pixel_angle) const;

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
  [[nodiscard]] HitPacket first_of(const HitPacket& fixed, const HitPacket& movers) const;
  [[nodiscard]] FaceLookup look_up_face(const Primitive& solid, const SurfacePoint& point, float cosine,
                                        float footprint_m) const;
  [[nodiscard]] SurfaceLook look_at(const RayPacket& rays, const HitPacket& hits, int lane,
                                    float pixel_angle) const;
  [[nodiscard]] Lanes lane_color(const RayPacket& rays, const HitPacket& hits, int lane,
                                 float pixel_angle) const;
  [[nodiscard]] Lanes light_at(int primitive, const SurfacePoint& point) const;

  const Scene* scene_;
  int fixed_count_;
  MoverPoses movers_;
  Bvh bvh_;  ///< of the movers
};

}  // namespace kinloop::sim
