#pragma once
// Pose graphs with ground truth: a circular path with loop closures between the rounds.

#include <cmath>

#include "kinloop/core/random.hpp"
#include "kinloop/optimize/pose_graph/pose_graph.hpp"
#include "kinloop/optimize/pose_graph/pose_graph_error.hpp"

namespace kinloop::test {

inline SE3 make_pose(const SE3& /*kind*/, double x, double y, double heading_rad, double wobble) {
  return {exp_so3(Eigen::Vector3d(wobble, -0.5 * wobble, heading_rad)), {x, y, wobble}};
}

inline SE2 make_pose(const SE2& /*kind*/, double x, double y, double heading_rad, double /*wobble*/) {
  return {{x, y}, normalized_angle(heading_rad)};
}

template <class Pose>
typename BasicPoseGraph<Pose>::Vector random_tangent(Random& random, double sigma) {
  typename BasicPoseGraph<Pose>::Vector d;
  for (int i = 0; i < d.size(); ++i) d[i] = sigma * random.gaussian();
  return d;
}

/// A full, well-conditioned information matrix.
template <class Pose>
typename BasicPoseGraph<Pose>::Matrix random_information(Random& random, double sigma) {
  using Matrix = typename BasicPoseGraph<Pose>::Matrix;
  Matrix root;
  for (int i = 0; i < root.size(); ++i) root.data()[i] = 0.2 * random.gaussian();
  root += Matrix::Identity();
  const Matrix information = root * root.transpose() / (sigma * sigma);
  return 0.5 * (information + information.transpose());  // exactly symmetric
}

struct LoopWorldOptions {
  int rounds = 3;
  int poses_per_round = 20;
  double sigma = 0.01;       // of the measurements, metres and radians
  double false_loops = 0;    // fraction of the loop edges that are wrong
  double start_sigma = 0.1;  // of the initial values
};

template <class Pose>
struct LoopWorld {
  std::vector<Pose> truth;
  BasicPoseGraph<Pose> graph;
};

template <class Pose>
LoopWorld<Pose> make_loop_world(const LoopWorldOptions& options, uint64_t seed) {
  Random random(seed);
  LoopWorld<Pose> world;
  const int count = options.rounds * options.poses_per_round;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * i / options.poses_per_round;
    world.truth.push_back(
        make_pose(Pose{}, 3 * std::cos(angle), 2 * std::sin(angle), angle, 0.3 * std::sin(0.7 * i)));
    world.graph.T_world_vertex.push_back(
        i == 0 ? world.truth[0]
               : retract(world.truth.back(), random_tangent<Pose>(random, options.start_sigma)));
  }
  const auto measure = [&](int a, int b, bool is_odometry) {
    const auto ua = static_cast<uint32_t>(a), ub = static_cast<uint32_t>(b);
    const Pose exact = world.truth[ua].inverse() * world.truth[ub];
    world.graph.edges.push_back({ua, ub, retract(exact, random_tangent<Pose>(random, options.sigma)),
                                 random_information<Pose>(random, options.sigma > 0 ? options.sigma : 1),
                                 is_odometry});
  };
  for (int i = 1; i < count; ++i) measure(i - 1, i, true);
  for (int i = options.poses_per_round; i < count; i += 2) {
    measure(i - options.poses_per_round, i, false);
    if (random.uniform() < options.false_loops) {
      auto& edge = world.graph.edges.back();
      edge.a = random.index(static_cast<uint32_t>(i));
    }
  }
  return world;
}

/// Largest distance between two sets of poses, metres and radians mixed.
template <class Pose>
double largest_difference(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, edge_error(a[i], b[i], Pose{}).norm());
  return largest;
}

}  // namespace kinloop::test
