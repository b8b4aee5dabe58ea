#pragma once
// The error e of an edge as defined by g2o, and its derivatives with respect to the tangent vectors d of its
// poses, T <- retract(T, d) = T * (d_translation; exp(d_rotation)).

#include <cmath>

#include "kinloop/optimize/pose_graph/pose_graph.hpp"

namespace kinloop {

/// The error of an edge with its derivatives with respect to poses a and b.
template <class Pose>
struct LinearizedError {
  typename BasicPoseGraph<Pose>::Vector e;
  typename BasicPoseGraph<Pose>::Matrix de_da, de_db;
};

inline SE3 retract(const SE3& T, const Vector6d& d) {
  return T * SE3{exp_so3(d.tail<3>()), d.head<3>()};
}

inline SE2 retract(const SE2& T, const Eigen::Vector3d& d) {
  return T * SE2{d.head<2>(), d.z()};
}

/// Returns the error of g2o's EDGE_SE3:QUAT.
inline Vector6d edge_error(const SE3& T_world_a, const SE3& T_world_b, const SE3& T_a_b) {
  const SE3 E = T_a_b.inverse() * (T_world_a.inverse() * T_world_b);
  Vector6d e;
  e << E.translation, (E.rotation.w() < 0 ? -1.0 : 1.0) * E.rotation.vec();
  return e;
}

/// Returns the error of g2o's EDGE_SE2.
inline Eigen::Vector3d edge_error(const SE2& T_world_a, const SE2& T_world_b, const SE2& T_a_b) {
  const SE2 E = T_a_b.inverse() * (T_world_a.inverse() * T_world_b);
  return {E.translation.x(), E.translation.y(), E.angle_rad};
}

inline LinearizedError<SE3> linearize_edge(const SE3& T_world_a, const SE3& T_world_b, const SE3& T_a_b) {
  const SE3 T_a_b_now = T_world_a.inverse() * T_world_b;
  const SE3 E = T_a_b.inverse() * T_a_b_now;
  const double sign = E.rotation.w() < 0 ? -1.0 : 1.0;
  const double w = sign * E.rotation.w();
  const Eigen::Vector3d v = sign * E.rotation.vec();
  const Eigen::Matrix3d R_b_a = T_a_b.R().transpose();
  const Eigen::Matrix3d V = skew(v);
  const Eigen::Matrix3d W = w * Eigen::Matrix3d::Identity();

  LinearizedError<SE3> result;
  result.e << E.translation, v;
  // q * (1; d/2) has the vector part v + (w + [v]x) d/2, and (1; -R_b_a d/2) * q has v - (w - [v]x) R_b_a
  // d/2.
  result.de_da.topLeftCorner<3, 3>() = -R_b_a;
  result.de_da.topRightCorner<3, 3>() = R_b_a * skew(T_a_b_now.translation);
  result.de_da.bottomLeftCorner<3, 3>().setZero();
  result.de_da.bottomRightCorner<3, 3>() = -0.5 * (W - V) * R_b_a;
  result.de_db.topLeftCorner<3, 3>() = E.R();
  result.de_db.topRightCorner<3, 3>().setZero();
  result.de_db.bottomLeftCorner<3, 3>().setZero();
  result.de_db.bottomRightCorner<3, 3>() = 0.5 * (W + V);
  return result;
}

inline LinearizedError<SE2> linearize_edge(const SE2& T_world_a, const SE2& T_world_b, const SE2& T_a_b) {
  const SE2 T_a_b_now = T_world_a.inverse() * T_world_b;
  const SE2 E = T_a_b.inverse() * T_a_b_now;
  const Eigen::Matrix2d R_b_a = T_a_b.R().transpose();
  const Eigen::Vector2d& t = T_a_b_now.translation;

  LinearizedError<SE2> result;
  result.e << E.translation, E.angle_rad;
  result.de_da.topLeftCorner<2, 2>() = -R_b_a;
  result.de_da.topRightCorner<2, 1>() = R_b_a * Eigen::Vector2d(t.y(), -t.x());
  result.de_da.bottomRows<1>() << 0, 0, -1;
  result.de_db.setIdentity();
  result.de_db.topLeftCorner<2, 2>() = E.R();
  return result;
}

/// Returns the pose of vertex a of an edge, or the identity for a prior.
template <class Pose>
Pose pose_of_a(const std::vector<Pose>& T_world_vertex, const typename BasicPoseGraph<Pose>::Edge& edge) {
  return edge.a == kWorld ? Pose{} : T_world_vertex[edge.a];
}

/// Returns e' Omega e of one edge.
template <class Pose>
double edge_chi2(const std::vector<Pose>& T_world_vertex, const typename BasicPoseGraph<Pose>::Edge& edge) {
  const auto e = edge_error(pose_of_a(T_world_vertex, edge), T_world_vertex[edge.b], edge.T_a_b);
  return e.dot(edge.information * e);
}

}  // namespace kinloop
