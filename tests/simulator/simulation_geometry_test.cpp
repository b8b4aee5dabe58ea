// Solids, their bounding volume hierarchy, and textures.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "kinloop/core/random.hpp"
#include "simulator/paint/texture.hpp"
#include "simulator/render/bvh.hpp"

namespace kinloop::sim {
namespace {

Eigen::Vector3f random_vector(Random& random, double size) {
  const auto draw = [&] { return static_cast<float>(random.uniform(-size, size)); };
  const float x = draw(), y = draw(), z = draw();
  return {x, y, z};
}

std::vector<Primitive> random_solids(int count, uint64_t seed) {
  Random random(seed);
  std::vector<Primitive> solids;
  for (int i = 0; i < count; ++i) {
    Primitive solid;
    solid.shape = static_cast<Shape>(random.index(3));
    solid.center = random_vector(random, 3);
    solid.half = random_vector(random, 0.4).cwiseAbs().array() + 0.02F;
    if (solid.shape != Shape::kBox) solid.half.y() = solid.half.x();
    if (solid.shape == Shape::kSphere) solid.half.z() = solid.half.x();
    if (i % 2 == 0) {
      const Eigen::Vector3f axis = random_vector(random, 1).normalized();
      solid.R_room_local =
          Eigen::AngleAxisf(static_cast<float>(random.uniform(0, 3)), axis).toRotationMatrix();
    }
    solids.push_back(solid);
  }
  return solids;
}

RayPacket random_rays(Random& random) {
  RayPacket rays{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const Eigen::Vector3f origin = random_vector(random, 0.05), direction = random_vector(random, 1);
    rays.origin.x[lane] = origin.x();
    rays.origin.y[lane] = origin.y();
    rays.origin.z[lane] = origin.z();
    rays.direction.x[lane] = direction.x();
    rays.direction.y[lane] = direction.y();
    rays.direction.z[lane] = direction.z();
  }
  return rays;
}

double distance_to_all(const std::vector<Primitive>& solids, const Eigen::Vector3d& p) {
  double nearest = 1e9;
  for (const Primitive& solid : solids) nearest = std::min(nearest, signed_distance_m(solid, p));
  return nearest;
}

/// First hit by sphere tracing (Hart 1996, "Sphere tracing"): shares no formula with the hierarchy.
double sphere_traced_distance(const std::vector<Primitive>& solids, const LaneRay& ray, double max_t) {
  const Eigen::Vector3d direction = ray.direction.cast<double>();
  double t = 0;
  for (int step = 0; step < 10000 && t < max_t; ++step) {
    const double distance = distance_to_all(solids, ray.point.cast<double>() + t * direction);
    if (distance < 1e-7) return t;
    t += distance / direction.norm();
  }
  return max_t;
}

TEST(SimulatedSolids, HierarchyAgreesWithSphereTracing) {
  std::vector<Primitive> solids = random_solids(60, 5);
  std::erase_if(solids, [](const Primitive& s) { return signed_distance_m(s, {0, 0, 0}) < 0.15; });
  const Bvh bvh(solids);
  Random random(7);
  int hits_seen = 0;
  constexpr float kMaxT = 20;
  for (int i = 0; i < 200; ++i) {
    const RayPacket rays = random_rays(random);
    const HitPacket hits = bvh.nearest(rays, kMaxT);
    for (int lane = 0; lane < kLanes; ++lane) {
      const double walked = sphere_traced_distance(solids, lane_ray(rays, all_lanes(0), lane), kMaxT);
      const double scale = lane_ray(rays, hits.t, lane).direction.norm();
      // Grazing rays depend on rounding: there, the hit only has to lie on the surface.
      if (std::abs(walked - hits.t[lane]) * scale > 1e-3) {
        EXPECT_LT(std::abs(distance_to_all(solids, lane_ray(rays, hits.t, lane).point.cast<double>())), 1e-4);
        continue;
      }
      if (hits.primitive[lane] < 0) continue;
      ++hits_seen;
      const auto& solid = solids[static_cast<size_t>(hits.primitive[lane])];
      EXPECT_NEAR(signed_distance_m(solid, lane_ray(rays, hits.t, lane).point.cast<double>()), 0, 1e-5);
    }
  }
  EXPECT_GT(hits_seen, 100);
}

TEST(SimulatedSolids, CandidatesOfABundleGiveTheSameHitsAsTheWholeTree) {
  const std::vector<Primitive> solids = random_solids(200, 11);
  const Bvh bvh(solids);
  Random random(13);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f towards = random_vector(random, 1);
    std::vector<RayPacket> packets;
    RayBundle bundle;
    for (int k = 0; k < 6; ++k) {
      RayPacket rays = random_rays(random);
      rays.direction = {towards.x() + 0.03F * rays.direction.x, towards.y() + 0.03F * rays.direction.y,
                        towards.z() + 0.03F * rays.direction.z};
      packets.push_back(rays);
      bundle.extend(rays);
    }
    const auto candidates = bvh.candidates(bundle);
    for (const RayPacket& rays : packets) {
      const HitPacket whole = bvh.nearest(rays, 30), few = bvh.nearest(rays, 30, candidates);
      EXPECT_FALSE(any(whole.primitive != few.primitive));
      EXPECT_FALSE(any(whole.t != few.t));
    }
  }
}

TEST(SimulatedSolids, AnEmptySceneIsNeverHit) {
  Random random(1);
  const HitPacket hits = Bvh(std::vector<Primitive>{}).nearest(random_rays(random), 10);
  EXPECT_FALSE(any(hits.primitive != -1));
}

TEST(SimulatedSolids, SurfaceCoordinatesAreInvertible) {
  for (const Primitive& solid : random_solids(30, 3)) {
    for (int face = 0; face < kFaces; ++face) {
      const Eigen::Vector2f size = face_size_m(solid, face);
      if (size.isZero()) continue;
      for (const float u : {0.1F, 0.45F, 0.9F}) {
        for (const float v : {0.2F, 0.7F}) {
          const bool off_cap =
              std::hypot(2 * u - 1, 2 * v - 1) > 0.99;  // a cap is the disc within its square
          if (solid.shape == Shape::kCylinder && face >= kBottom && off_cap) continue;
          const SurfaceFrame frame = surface_frame(solid, face, u, v);
          const SurfacePoint point = locate(solid, frame.p_local);
          EXPECT_EQ(point.face, face);
          EXPECT_NEAR(point.u, u, 1e-4);
          EXPECT_NEAR(point.v, v, 1e-4);
          EXPECT_NEAR((normal_at(solid, frame.p_local) - frame.normal_local).norm(), 0, 1e-4);
          const Eigen::Vector3f p_room = solid.R_room_local * frame.p_local + solid.center;
          EXPECT_NEAR(signed_distance_m(solid, p_room.cast<double>()), 0, 1e-5);
        }
      }
    }
  }
}

TEST(SimulatedSolids, HitsOfEllipsoidsLieOnTheirSurfaceAndFaceTheRay) {
  Random random(3);
  const auto draw = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
  int hits_seen = 0;
  for (int i = 0; i < 200; ++i) {
    Primitive solid;
    solid.shape = Shape::kEllipsoid;
    for (int axis = 0; axis < 3; ++axis) solid.half[axis] = draw(0.05, 0.5);
    solid.center = Eigen::Vector3f(2, 0, 0);
    solid.R_room_local = Eigen::AngleAxisf(draw(0, 3), Eigen::Vector3f(1, 2, 3).normalized()).matrix();
    RayPacket rays = {all_lanes3(0), {all_lanes(1), all_lanes(draw(-0.2, 0.2)), all_lanes(draw(-0.2, 0.2))}};
    const HitPacket hits = Bvh({solid}).nearest(rays, 10);
    const LaneRay ray = lane_ray(rays, hits.t, 0);
    if (hits.primitive[0] < 0) continue;
    ++hits_seen;
    EXPECT_NEAR(signed_distance_m(solid, ray.point.cast<double>()), 0, 1e-4);
    const Eigen::Vector3f p_local = solid.R_room_local.transpose() * (ray.point - solid.center);
    EXPECT_LE((solid.R_room_local * normal_at(solid, p_local)).dot(ray.direction), 1e-3F);
    EXPECT_TRUE(bounds(solid).contains(ray.point));
    const SurfacePoint at = locate(solid, p_local);
    const SurfaceFrame frame = surface_frame(solid, at.face, at.u, at.v);
    EXPECT_NEAR((frame.p_local - p_local).norm(), 0, 2e-3);
    EXPECT_GT(frame.normal_local.dot(normal_at(solid, p_local)), 0.999F);
  }
  EXPECT_GT(hits_seen, 60);
}

TEST(SimulatedTexture, AWideFootprintGivesTheMeanAndNoneThePixel) {
  cv::Mat image(64, 128, CV_8UC3);
  Random random(2);
  for (auto it = image.begin<cv::Vec3b>(); it != image.end<cv::Vec3b>(); ++it) {
    for (int c = 0; c < 3; ++c) (*it)[c] = static_cast<uint8_t>(random.index(256));
  }
  const Texture texture(image);
  const Lanes pixel = texture.sample(10.5F / 128, 20.5F / 64, 0);
  const Lanes mean = texture.sample(0.3F, 0.3F, 1e6F);
  const cv::Scalar expected = cv::mean(image);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(pixel[c], image.at<cv::Vec3b>(20, 10)[c], 1e-3);
    EXPECT_NEAR(mean[c], expected[c], 3);  // every halving rounds to integers
  }
  const Lanes repeated = texture.sample(3 + 10.5F / 128, -2 + 20.5F / 64, 0);
  EXPECT_NEAR(repeated[0], pixel[0], 1e-2);
}

TEST(SimulatedTexture, FinePatternsAreFilteredWithoutAliasing) {
  cv::Mat stripes(64, 64, CV_8UC3, cv::Scalar::all(0));
  for (int x = 0; x < 64; x += 2) stripes.col(x).setTo(cv::Scalar::all(255));
  const Texture texture(stripes);
  for (float u = 0; u < 1; u += 0.013F) EXPECT_NEAR(texture.sample(u, 0.5F, 4)[0], 127.5, 2);
}

TEST(SimulatedTexture, NonPowerOfTwoSizesThrow) {
  EXPECT_THROW(Texture(cv::Mat(60, 64, CV_8UC3)), std::logic_error);
}

}  // namespace
}  // namespace kinloop::sim
