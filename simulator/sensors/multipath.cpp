#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/threads/parallel_for.hpp"
#include "simulator/sensors/depth_models.hpp"

namespace kinloop::sim {
namespace {

constexpr int kBlock_px = 8;
constexpr int kPackets = 12;                // of directions in which a surface looks for light
constexpr float kFarthest_m = 50;           // maximum ray length
constexpr float kLightOffset_m = 0.002F;    // of ray origins from the surface
constexpr float kReflectanceAngle = 0.02F;  // width of the rays at distance 1: reflectance needs no detail

/// At 80 MHz, the middle one of a Kinect 2's three frequencies, the phase repeats after 1.874 m. Light by way
/// of distant surfaces cancels at such a frequency (Gupta et al. 2015, "Phasor imaging").
constexpr float kPhasePerM = 2 * std::numbers::pi_v<float> / 1.874F;  // of range, rad / m

using Point = Eigen::Vector3f;

RayPacket ray_packet(const std::array<Point, kLanes>& from, const std::array<Point, kLanes>& along) {
  RayPacket rays{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const Point &o = from[static_cast<size_t>(lane)], &d = along[static_cast<size_t>(lane)];
    rays.origin.x[lane] = o.x(), rays.origin.y[lane] = o.y(), rays.origin.z[lane] = o.z();
    rays.direction.x[lane] = d.x(), rays.direction.y[lane] = d.y(), rays.direction.z[lane] = d.z();
  }
  return rays;
}

/// A surface point lit by the lamp at the camera.
struct LitPoint {
  Point position = Point::Zero(), normal = Point::Zero();
  float range_m = 0, light = 0;  ///< Lambert's cosine by the squared range
};

class LightPaths {
 public:
  LightPaths(const Moment& moment, const PinholeCamera& camera, const SE3& T_room_camera)
      : moment_(moment),
        camera_(camera),
        T_camera_room_(T_room_camera.inverse()),
        lamp_(T_room_camera.translation.cast<float>()) {}

  [[nodiscard]] float error_m(const Point& along) const {
    std::array<Point, kLanes> from, rays;
    from.fill(lamp_);
    rays.fill(along);
    const RayPacket view = ray_packet(from, rays);
    const HitPacket hit = moment_.nearest(view, kFarthest_m);
    if (!(moment_.infrared_cosine(view, hit, 0) > 0)) return 0;
    const LitPoint seen = lit_point(view, hit, 0);
    std::complex<float> direct(seen.light, 0), indirect(0, 0);
    for (int i = 0; i < kPackets; ++i) indirect += light_by_others(seen, i);
    return std::arg(direct + indirect / static_cast<float>(kPackets * kLanes)) / kPhasePerM;
  }

 private:
  [[nodiscard]] LitPoint lit_point(const RayPacket& rays, const HitPacket& hits, int lane) const {
    const Primitive& solid = moment_.primitive(hits.primitive[lane]);
    LitPoint point;
    point.position = lane_ray(rays, hits.t, lane).point;
    point.normal = solid.R_room_local *
                   normal_at(solid, solid.R_room_local.transpose() * (point.position - solid.center));
    const Point to_lamp = lamp_ - point.position;
    point.range_m = to_lamp.norm();
    const float cosine = std::max(0.0F, point.normal.dot(to_lamp) / point.range_m);
    point.light = cosine / (point.range_m * point.range_m);
    return point;
  }

  /// The sum over the directions of one packet, spread by the cosine.
  [[nodiscard]] std::complex<float> light_by_others(const LitPoint& seen, int packet_index) const {
    const Point side = seen.normal.unitOrthogonal(), other = seen.normal.cross(side);
    constexpr float kGoldenTurn = 2.39996323F;
    std::array<Point, kLanes> from, along;
    for (int lane = 0; lane < kLanes; ++lane) {  // spiral of evenly spread directions
      const auto index = static_cast<float>(packet_index * kLanes + lane);
      const float s = (index + 0.5F) / (kPackets * kLanes), turn = kGoldenTurn * index;
      from[static_cast<size_t>(lane)] = seen.position + kLightOffset_m * seen.normal;
      along[static_cast<size_t>(lane)] =
          std::sqrt(s) * (std::cos(turn) * side + std::sin(turn) * other) + std::sqrt(1 - s) * seen.normal;
    }
    const RayPacket rays = ray_packet(from, along);
    return sum_of_paths(seen, rays, moment_.nearest(rays, kFarthest_m));
  }

  [[nodiscard]] std::complex<float> sum_of_paths(const LitPoint& seen, const RayPacket& rays,
                                                 const HitPacket& hits) const {
    std::array<LitPoint, kLanes> points{};
    std::array<Point, kLanes> from, to_lamp;
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto i = static_cast<size_t>(lane);
      if (hits.primitive[lane] >= 0) points[i] = lit_point(rays, hits, lane);
      from[i] = points[i].position + kLightOffset_m * points[i].normal;
      to_lamp[i] = lamp_ - from[i];
    }
    const LaneMask blocker = moment_.nearest(ray_packet(from, to_lamp), 1.0F).primitive;
    std::complex<float> sum(0, 0);
    for (int lane = 0; lane < kLanes; ++lane) {
      const LitPoint& by = points[static_cast<size_t>(lane)];
      if (hits.primitive[lane] < 0 || blocker[lane] >= 0 || !in_view(by.position)) continue;
      const float light = by.light * moment_.infrared_reflectance(rays, hits, lane, kReflectanceAngle);
      const float extra_m = (by.range_m + hits.t[lane] - seen.range_m) / 2;
      sum += std::polar(light, kPhasePerM * extra_m);
    }
    return sum;
  }

  /// The lamp lights what the camera sees, and little else.
  [[nodiscard]] bool in_view(const Point& p_room) const {
    const Eigen::Vector3d p = T_camera_room_ * p_room.cast<double>();
    return p.z() > 0 && camera_.contains(camera_.project(p));
  }

  const Moment& moment_;
  const PinholeCamera& camera_;
  SE3 T_camera_room_;
  Point lamp_;
};

}  // namespace

cv::Mat multipath_error_m(const Moment& moment, const PinholeCamera& camera, const SE3& T_room_camera,
                          int threads) {
  const cv::Size blocks((camera.width + kBlock_px - 1) / kBlock_px,
                        (camera.height + kBlock_px - 1) / kBlock_px);
  const LightPaths paths(moment, camera, T_room_camera);
  const Eigen::Matrix3d R = T_room_camera.R();
  cv::Mat errors_m(blocks, CV_32FC1), result;
  parallel_for(static_cast<size_t>(blocks.height), threads, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < blocks.width; ++x) {
        const Eigen::Vector2d middle((x + 0.5) * camera.width / blocks.width - 0.5,
                                     (y + 0.5) * camera.height / blocks.height - 0.5);
        const Eigen::Vector3d along = R * camera.unproject(camera.undistort(middle), 1);
        errors_m.at<float>(y, x) = paths.error_m(along.cast<float>());
      }
    }
  });
  cv::resize(errors_m, result, {camera.width, camera.height}, 0, 0, cv::INTER_LINEAR);
  return result;
}

}  // namespace kinloop::sim
