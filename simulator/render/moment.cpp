#include "simulator/render/moment.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace kinloop::sim {
namespace {

/// Four rays that hit the same face of a box.
struct CommonFace {
  SurfacePoint middle;
  Lanes u, v;
  float cosine;
};

/// Returns nullopt if the four points lie on different faces.
std::optional<CommonFace> common_face(const Primitive& box, const RayPacket& rays, Lanes t) {
  const Lanes3 p{rays.origin.x + t * rays.direction.x - box.center.x(),
                 rays.origin.y + t * rays.direction.y - box.center.y(),
                 rays.origin.z + t * rays.direction.z - box.center.z()};
  const Eigen::Matrix3f& R = box.R_room_local;
  const auto along = [&](int axis) { return R(0, axis) * p.x + R(1, axis) * p.y + R(2, axis) * p.z; };
  const Lanes local[3] = {along(0), along(1), along(2)};
  CommonFace face{};
  face.middle = locate(box, {local[0][0], local[1][0], local[2][0]});
  const int axis = face.middle.face / 2;
  constexpr float kOnFace_m = 1e-4F;
  const Lanes height = face.middle.face % 2 == 1 ? local[axis] : -local[axis];
  if (any(height < box.half[axis] - kOnFace_m)) return std::nullopt;
  const Eigen::Vector3f d = lane_ray(rays, t, 0).direction;
  face.cosine = std::abs(R.col(axis).dot(d)) / d.norm();
  face.u = 0.5F + local[axis == 0 ? 1 : 0] / face.middle.width_m;
  face.v = 0.5F - local[axis == 2 ? 1 : 2] / face.middle.height_m;
  face.middle.u = 0.25F * (face.u[0] + face.u[1] + face.u[2] + face.u[3]);
  face.middle.v = 0.25F * (face.v[0] + face.v[1] + face.v[2] + face.v[3]);
  return face;
}

/// Cosine of the incidence angle, at least 0.
float incidence(const Primitive& solid, const LaneRay& ray) {
  const Eigen::Vector3f p_local = solid.R_room_local.transpose() * (ray.point - solid.center);
  const Eigen::Vector3f normal = solid.R_room_local * normal_at(solid, p_local);
  return std::max(0.0F, -normal.dot(ray.direction) / ray.direction.norm());
}

}  // namespace

Moment::Moment(const Scene& scene, int64_t stamp_ns)
    : scene_(&scene),
      fixed_count_(static_cast<int>(scene.primitives().size())),
      movers_(scene.movers().at(stamp_ns)),
      bvh_(movers_.parts) {}

HitPacket Moment::first_of(const HitPacket& fixed, const HitPacket& movers) const {
  const LaneMask nearer = (movers.primitive >= 0) & (movers.t < fixed.t);
  return {nearer ? movers.t : fixed.t, nearer ? movers.primitive + fixed_count_ : fixed.primitive};
}

HitPacket Moment::nearest(const RayPacket& rays, float max_t) const {
  const HitPacket fixed = scene_->bvh().nearest(rays, max_t);
  return movers_.parts.empty() ? fixed : first_of(fixed, bvh_.nearest(rays, max_t));
}

HitPacket Moment::nearest(const RayPacket& rays, float max_t, const MomentCandidates& candidates) const {
  const HitPacket fixed = scene_->bvh().nearest(rays, max_t, candidates.fixed);
  if (candidates.movers.empty()) return fixed;
  return first_of(fixed, bvh_.nearest(rays, max_t, candidates.movers));
}

const Primitive& Moment::primitive(int index) const {
  return index < fixed_count_ ? scene_->primitives()[static_cast<size_t>(index)]
                              : movers_.parts[static_cast<size_t>(index - fixed_count_)];
}

Motion Moment::motion_of(int primitive) const {
  if (primitive < fixed_count_) return Motion::kNone;
  const auto mover = static_cast<size_t>(primitive - fixed_count_);
  return mover < movers_.in_motion ? Motion::kMoving : Motion::kAtRest;
}

/// Movers cast no shadows and take none: what they are lit by changes with their place.
Lanes Moment::light_at(int primitive, const SurfacePoint& point) const {
  if (primitive < fixed_count_) return scene_->light_map().at(primitive, point);
  const Primitive& solid = this->primitive(primitive);
  const SurfaceFrame frame = surface_frame(solid, point.face, point.u, point.v);
  return open_brightness(scene_->lights(), solid.R_room_local * frame.p_local + solid.center,
                         solid.R_room_local * frame.normal_local);
}

Moment::FaceLookup Moment::look_up_face(const Primitive& solid, const SurfacePoint& point, float cosine,
                                        float footprint_m) const {
  const bool picture = point.face == solid.picture_face;
  FaceLookup lookup{};
  lookup.face_texture = picture ? &solid.picture : &solid.face_texture;
  lookup.texture = &scene_->textures()[static_cast<size_t>(lookup.face_texture->texture)];
  lookup.u_span = lookup.face_texture->u_scale * (lookup.face_texture->fitted ? 1 : point.width_m);
  lookup.v_span = lookup.face_texture->v_scale * (lookup.face_texture->fitted ? 1 : point.height_m);
  lookup.emissive = solid.emissive && (picture || solid.picture_face == kNoFace);
  // Texture pixels per metre, in the denser of the two directions.
  const float density =
      std::max(lookup.u_span * static_cast<float>(lookup.texture->width()) / point.width_m,
               lookup.v_span * static_cast<float>(lookup.texture->height()) / point.height_m);
  // A slanted surface stretches the footprint in one direction only; scaling it by the square root is a
  // compromise between blur along and aliasing across.
  constexpr float kMinCosine = 0.04F;
  lookup.footprint_px = density * footprint_m / std::sqrt(std::max(cosine, kMinCosine));
  return lookup;
}

Moment::SurfaceLook Moment::look_at(const RayPacket& rays, const HitPacket& hits, int lane,
                                    float pixel_angle) const {
  const LaneRay ray = lane_ray(rays, hits.t, lane);
  const Primitive& solid = primitive(hits.primitive[lane]);
  const SurfacePoint point = locate(solid, solid.R_room_local.transpose() * (ray.point - solid.center));
  const FaceLookup lookup = look_up_face(solid, point, incidence(solid, ray), hits.t[lane] * pixel_angle);
  const Lanes albedo =
      lookup.texture->sample(lookup.face_texture->u0 + lookup.u_span * point.u,
                             lookup.face_texture->v0 + lookup.v_span * point.v, lookup.footprint_px);
  return {point, albedo, lookup.emissive};
}

Lanes Moment::lane_color(const RayPacket& rays, const HitPacket& hits, int lane, float pixel_angle) const {
  const int primitive = hits.primitive[lane];
  if (primitive < 0) return all_lanes(0);
  const SurfaceLook look = look_at(rays, hits, lane, pixel_angle);
  return look.emissive ? look.albedo : look.albedo * light_at(primitive, look.point);
}

Lanes Moment::mean_color(const RayPacket& rays, const HitPacket& hits, float pixel_angle) const {
  constexpr float kShare = 1.0F / kLanes;
  const int primitive = hits.primitive[0];
  if (primitive >= 0 && !any(hits.primitive != hits.primitive[0])) {
    const Primitive& solid = this->primitive(primitive);
    if (solid.shape == Shape::kBox) {
      if (const auto face = common_face(solid, rays, hits.t)) {
        // All four on one face of a box, the common case: one texture and light lookup for all.
        const SurfacePoint& point = face->middle;
        const FaceLookup lookup = look_up_face(solid, point, face->cosine, hits.t[0] * pixel_angle);
        const Lanes u = lookup.face_texture->u0 + lookup.u_span * face->u,
                    v = lookup.face_texture->v0 + lookup.v_span * face->v;
        const Lanes albedo = kShare * lookup.texture->sample_sum(u, v, lookup.footprint_px);
        return lookup.emissive ? albedo : albedo * light_at(primitive, point);
      }
    }
  }
  Lanes sum = all_lanes(0);
  for (int lane = 0; lane < kLanes; ++lane) sum += lane_color(rays, hits, lane, pixel_angle);
  return kShare * sum;
}

float Moment::infrared_cosine(const RayPacket& rays, const HitPacket& hits, int lane) const {
  const int primitive = hits.primitive[lane];
  if (primitive < 0) return 0;
  const Primitive& solid = this->primitive(primitive);
  return solid.no_depth_return ? 0 : incidence(solid, lane_ray(rays, hits.t, lane));
}

float Moment::infrared_reflectance(const RayPacket& rays, const HitPacket& hits, int lane,
                                   float pixel_angle) const {
  constexpr float kWhite = 255, kLeast = 0.04F;  // glossy black plastic, as of a screen, still reflects
  constexpr int kRed = 2;                        // the channel next to infrared
  if (hits.primitive[lane] < 0) return 0;
  const SurfaceLook look = look_at(rays, hits, lane, pixel_angle);
  const float level = look.albedo[kRed] / kWhite;
  return look.emissive ? kLeast : std::max(level * level, kLeast);  // textures have a gamma of about 2
}

}  // namespace kinloop::sim
