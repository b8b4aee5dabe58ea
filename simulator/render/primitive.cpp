#include "simulator/render/primitive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kinloop::sim {
namespace {

struct FaceAxes {
  int normal, u, v;
};

FaceAxes axes_of(int face) {
  constexpr FaceAxes kAxes[] = {{0, 1, 2}, {1, 0, 2}, {2, 0, 1}};
  return kAxes[face / 2];
}

float turn_fraction(const Eigen::Vector3f& p) {
  return 0.5F * (std::atan2(p.y(), p.x()) / std::numbers::pi_v<float> + 1.0F);
}

int box_face(const Primitive& primitive, const Eigen::Vector3f& p) {
  int axis = 0;
  const Eigen::Array3f nearness = p.array().abs() - primitive.half.array();
  nearness.maxCoeff(&axis);
  return 2 * axis + (p[axis] > 0 ? 1 : 0);
}

/// The round side is face 0; the caps are numbered as for a box.
int cylinder_face(const Primitive& primitive, const Eigen::Vector3f& p) {
  const float from_side = std::hypot(p.x(), p.y()) - primitive.half.x();
  const float from_cap = std::abs(p.z()) - primitive.half.z();
  if (from_side >= from_cap) return 0;
  return p.z() > 0 ? kTop : kBottom;
}

}  // namespace

Eigen::Vector2f face_size_m(const Primitive& primitive, int face) {
  const Eigen::Vector3f& half = primitive.half;
  if (primitive.shape == Shape::kBox || (primitive.shape == Shape::kCylinder && face >= kBottom)) {
    const FaceAxes axes = axes_of(face);
    return {2 * half[axes.u], 2 * half[axes.v]};
  }
  if (face != 0) return {0, 0};
  const float height_m =
      primitive.shape == Shape::kCylinder ? 2 * half.z() : std::numbers::pi_v<float> * half.z();
  return {2 * std::numbers::pi_v<float> * half.x(), height_m};
}

SurfacePoint locate(const Primitive& primitive, const Eigen::Vector3f& p) {
  SurfacePoint at;
  if (primitive.shape == Shape::kBox) at.face = box_face(primitive, p);
  if (primitive.shape == Shape::kCylinder) at.face = cylinder_face(primitive, p);
  const Eigen::Vector2f size_m = face_size_m(primitive, at.face);
  at.width_m = size_m.x();
  at.height_m = size_m.y();
  if (primitive.shape == Shape::kEllipsoid) {
    at.u = turn_fraction(p.cwiseQuotient(primitive.half));
    at.v = std::acos(std::clamp(p.z() / primitive.half.z(), -1.0F, 1.0F)) / std::numbers::pi_v<float>;
  } else if (primitive.shape == Shape::kSphere) {
    at.u = turn_fraction(p);
    at.v = std::acos(std::clamp(p.z() / primitive.half.z(), -1.0F, 1.0F)) / std::numbers::pi_v<float>;
  } else if (primitive.shape == Shape::kCylinder && at.face == 0) {
    at.u = turn_fraction(p);
    at.v = 0.5F - 0.5F * p.z() / primitive.half.z();
  } else {
    const FaceAxes axes = axes_of(at.face);
    at.u = 0.5F + p[axes.u] / at.width_m;
    at.v = 0.5F - p[axes.v] / at.height_m;
  }
  return at;
}

SurfaceFrame surface_frame(const Primitive& primitive, int face, float u, float v) {
  const Eigen::Vector3f& half = primitive.half;
  SurfaceFrame frame{Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
  if (primitive.shape == Shape::kBox || (primitive.shape == Shape::kCylinder && face >= kBottom)) {
    const FaceAxes axes = axes_of(face);
    const float sign = face % 2 == 1 ? 1.0F : -1.0F;
    frame.normal_local[axes.normal] = sign;
    frame.p_local[axes.normal] = sign * half[axes.normal];
    frame.p_local[axes.u] = (2 * u - 1) * half[axes.u];
    frame.p_local[axes.v] = (1 - 2 * v) * half[axes.v];
    return frame;
  }
  const float turn = (2 * u - 1) * std::numbers::pi_v<float>;
  const Eigen::Vector3f around(std::cos(turn), std::sin(turn), 0);
  if (primitive.shape == Shape::kCylinder) {
    frame.normal_local = around;
    frame.p_local = half.x() * around + Eigen::Vector3f(0, 0, (1 - 2 * v) * half.z());
  } else {
    frame.normal_local = std::sin(v * std::numbers::pi_v<float>) * around +
                         Eigen::Vector3f(0, 0, std::cos(v * std::numbers::pi_v<float>));
    frame.p_local = half.x() * frame.normal_local;
    if (primitive.shape == Shape::kEllipsoid) {
      frame.p_local = half.cwiseProduct(frame.normal_local);
      frame.normal_local = frame.normal_local.cwiseQuotient(half).normalized();
    }
  }
  return frame;
}

Eigen::Vector3f normal_at(const Primitive& primitive, const Eigen::Vector3f& p) {
  if (primitive.shape == Shape::kSphere) return p.normalized();
  if (primitive.shape == Shape::kEllipsoid) return p.cwiseQuotient(primitive.half.cwiseAbs2()).normalized();
  const int face = primitive.shape == Shape::kBox ? box_face(primitive, p) : cylinder_face(primitive, p);
  if (primitive.shape == Shape::kCylinder && face == 0) return Eigen::Vector3f(p.x(), p.y(), 0).normalized();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  normal[face / 2] = face % 2 == 1 ? 1.0F : -1.0F;
  return normal;
}

double signed_distance_m(const Primitive& primitive, const Eigen::Vector3d& p_room) {
  const Eigen::Vector3d p =
      primitive.R_room_local.cast<double>().transpose() * (p_room - primitive.center.cast<double>());
  const Eigen::Vector3d half = primitive.half.cast<double>();
  if (primitive.shape == Shape::kSphere) return p.norm() - half.x();
  if (primitive.shape == Shape::kEllipsoid) {
    const double scaled = p.cwiseQuotient(half).norm();
    const double gradient = p.cwiseQuotient(half.cwiseAbs2()).norm();
    return gradient > 0 ? scaled * (scaled - 1) / gradient : -half.minCoeff();
  }
  if (primitive.shape == Shape::kBox) {
    const Eigen::Vector3d outside = p.cwiseAbs() - half;
    return outside.cwiseMax(0.0).norm() + std::min(outside.maxCoeff(), 0.0);
  }
  const Eigen::Vector2d outside(p.head<2>().norm() - half.x(), std::abs(p.z()) - half.z());
  return outside.cwiseMax(0.0).norm() + std::min(outside.maxCoeff(), 0.0);
}

Eigen::AlignedBox3f bounds(const Primitive& primitive) {
  Eigen::Vector3f extent = primitive.half;
  if (primitive.shape == Shape::kEllipsoid) {
    extent = (primitive.R_room_local * primitive.half.asDiagonal()).rowwise().norm();
  } else if (primitive.shape != Shape::kSphere) {
    extent = primitive.R_room_local.cwiseAbs() * primitive.half;
  }
  return {primitive.center - extent, primitive.center + extent};
}

Primitive moved(Primitive primitive, float yaw_rad, const Eigen::Vector3f& translation) {
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(yaw_rad, Eigen::Vector3f::UnitZ()).toRotationMatrix();
  primitive.R_room_local = turn * primitive.R_room_local;
  primitive.center = turn * primitive.center + translation;
  return primitive;
}

}  // namespace kinloop::sim
