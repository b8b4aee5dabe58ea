#include "kinloop/loop/correction/correct_loop.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "kinloop/optimize/pose_graph/pose_graph_error.hpp"

namespace kinloop {
namespace {

PoseGraphEdge edge_between(const Map& map, KeyframeId a, KeyframeId b, int shared,
                           const LoopOptions& options) {
  return {a.value, b.value, map.relative_pose(a, b), edge_information(shared, options), true};
}

/// Edges from a keyframe to its predecessor and to older keyframes that share many landmarks and satisfy
/// `is_wanted`.
template <class Predicate>
void add_edges_to_older(const Map& map, const Keyframe& keyframe, const LoopOptions& options,
                        const Predicate& is_wanted, std::vector<PoseGraphEdge>& edges) {
  const auto previous = map.predecessor(keyframe.id);
  bool connected_to_previous = !previous;
  for (const auto& [older, shared] : map.covisible_keyframes(keyframe.id, 1)) {
    if (older > keyframe.id) continue;
    if (older != previous && (shared < options.covisibility_edge_min_landmarks || !is_wanted(older)))
      continue;
    edges.push_back(edge_between(map, older, keyframe.id, shared, options));
    connected_to_previous = connected_to_previous || older == previous;
  }
  if (!connected_to_previous) edges.push_back(edge_between(map, *previous, keyframe.id, 1, options));
}

/// The chi2 with 6 degrees of freedom that one of a thousand true edges exceeds: beyond, a loop is false.
constexpr double kMaxChi2 = 22.5;
/// That one of twenty exceeds: loops are looked at. The least-squares solution hides most of a misfit in the
/// odometry and in the other loops.
constexpr double kSuspiciousChi2 = 12.6;

/// The information that a loop is judged with. Landmarks of one view share errors, of calibration and of the
/// map around, that their number does not reduce: 1.6 cm and .6 degrees (1 sigma) with the default options.
Matrix6d judged_information(const LoopClosure& loop, const LoopOptions& options) {
  constexpr int kIndependentLandmarks = 10;
  const Matrix6d limit = edge_information(kIndependentLandmarks, options);
  const double ratio = (limit.diagonal().array() / loop.information.diagonal().array()).minCoeff();
  return std::min(1.0, ratio) * loop.information;
}

double judged_chi2(const LoopClosure& loop, const std::vector<SE3>& T_world_vertex,
                   const LoopOptions& options) {
  const Vector6d e = edge_error(T_world_vertex[loop.a.value], T_world_vertex[loop.b.value], loop.T_a_b);
  return e.dot(judged_information(loop, options) * e);
}

/// Whether all loops, as measured, fit the solved poses.
bool all_fit(const LoopCorrectionProblem& problem, const std::vector<SE3>& T_world_vertex,
             const LoopOptions& options) {
  return std::all_of(problem.loops.begin(), problem.loops.end(), [&](const LoopClosure& loop) {
    return judged_chi2(loop, T_world_vertex, options) <= kSuspiciousChi2;
  });
}

/// Solves all loops as measured, with the odometry before any of them, by graduated non-convexity.
std::vector<SE3> solve_robustly(const LoopCorrectionProblem& problem, const LoopOptions& options) {
  // Its edges share landmarks, three to a keyframe, and the errors of successive keyframes are correlated,
  // which adds five times the variance (online_covariance). Taken as independent, they outvote six loops that
  // agree.
  constexpr double kCorrelation = 15;
  PoseGraph graph{problem.graph.T_world_vertex, problem.graph.fixed, problem.odometry};
  for (PoseGraphEdge& edge : graph.edges) edge.information /= kCorrelation;
  for (const LoopClosure& loop : problem.loops)
    graph.edges.push_back({loop.a.value, loop.b.value, loop.T_a_b, judged_information(loop, options)});
  PoseGraphOptions robust = options.pose_graph;
  robust.solver = PoseGraphSolver::kBuiltin;  // it graduates
  robust.robust_kernel = RobustKernel::kGemanMcClure;
  robust.robust_width = std::sqrt(kMaxChi2);
  return solve_pose_graph(graph, robust).T_world_vertex;
}

/// The loops that do not fit these poses: the kernel's weight, 1 / (1 + chi2 / width^2)^2, is below a
/// quarter.
std::vector<size_t> misfits_of(const LoopCorrectionProblem& problem, const std::vector<SE3>& T_world_vertex,
                               const LoopOptions& options) {
  std::vector<size_t> misfits;
  for (size_t i = 0; i < problem.loops.size(); ++i) {
    if (judged_chi2(problem.loops[i], T_world_vertex, options) > kMaxChi2) misfits.push_back(i);
  }
  return misfits;
}

/// The poses as an update, with the merges of all loops but the withdrawn ones.
MapUpdate update_of(const LoopCorrectionProblem& problem, const std::vector<SE3>& T_world_vertex,
                    const std::vector<LoopEnds>& withdrawn) {
  MapUpdate update;
  update.newest_keyframe = problem.newest_keyframe;
  update.epoch = problem.epoch;
  for (uint32_t i = 0; i < T_world_vertex.size(); ++i)
    update.T_world_camera.emplace_back(KeyframeId{i}, T_world_vertex[i]);
  std::copy_if(problem.merges.begin(), problem.merges.end(), std::back_inserter(update.merges),
               [&](const LoopMerges& merges) {
                 return std::find(withdrawn.begin(), withdrawn.end(), merges.loop) == withdrawn.end();
               });
  return update;
}

/// The graph without the loops at these indices, in ascending order.
PoseGraph without(PoseGraph graph, size_t loops, const std::vector<size_t>& left_out) {
  const auto first = graph.edges.end() - static_cast<std::ptrdiff_t>(loops);
  for (auto index = left_out.rbegin(); index != left_out.rend(); ++index)
    graph.edges.erase(first + static_cast<std::ptrdiff_t>(*index));
  return graph;
}

}  // namespace

Matrix6d edge_information(int shared, const LoopOptions& options) {
  const double metres = options.landmark_sigma_m;
  const double half_radians =
      0.5 * options.landmark_sigma_rad;  // the vector part of a quaternion is half the angle
  Vector6d diagonal;
  diagonal.head<3>().setConstant(shared / (metres * metres));
  diagonal.tail<3>().setConstant(shared / (half_radians * half_radians));
  return diagonal.asDiagonal();
}

void OdometryBeforeLoops::observe(const Map& map, const LoopOptions& options) {
  for (; observed_ < map.keyframes().size(); ++observed_) {
    const Keyframe& keyframe = map.keyframe(KeyframeId{observed_});
    // What is seen again after a while is tied by loops, which may be false.
    const auto is_recent = [&](KeyframeId older) {
      return keyframe.id.value - older.value < static_cast<uint32_t>(options.min_gap_keyframes) &&
             map.keyframe(older).visit == keyframe.visit;
    };
    add_edges_to_older(map, keyframe, options, is_recent, edges_);
  }
  std::erase_if(edges_, [&](const PoseGraphEdge& edge) {
    return map.keyframe(KeyframeId{edge.a}).withdrawn || map.keyframe(KeyframeId{edge.b}).withdrawn;
  });
}

PoseGraph make_pose_graph(const Map& map, const LoopOptions& options, LoopEdges loops) {
  PoseGraph graph;
  std::set<uint32_t> held;
  for (const Keyframe& keyframe : map.keyframes()) {
    graph.T_world_vertex.push_back(keyframe.T_world_camera);
    graph.fixed.push_back(held.insert(keyframe.component).second);
  }
  for (const Keyframe& keyframe : map.keyframes())
    add_edges_to_older(
        map, keyframe, options, [](KeyframeId) { return true; }, graph.edges);
  for (const LoopClosure& loop : map.loop_closures()) {
    const bool by_map = loops == LoopEdges::kAsCorrected && loop.corrected;
    const SE3 T_a_b = by_map ? map.relative_pose(loop.a, loop.b) : loop.T_a_b;
    graph.edges.push_back({loop.a.value, loop.b.value, T_a_b, loop.information});
  }
  return graph;
}

LoopCorrectionProblem make_loop_correction_problem(const Map& map, std::vector<LoopMerges> merges,
                                                   const OdometryBeforeLoops& odometry,
                                                   const LoopOptions& options) {
  return {make_pose_graph(map, options, LoopEdges::kAsCorrected),
          map.loop_closures(),
          odometry.edges(),
          std::move(merges),
          map.keyframes().back().id,
          map.epoch()};
}

LoopCorrection correct_loop(const LoopCorrectionProblem& problem, const LoopOptions& options) {
  std::vector<SE3> T_world_vertex = solve_pose_graph(problem.graph, options.pose_graph).T_world_vertex;
  std::vector<size_t> misfits;
  if (!all_fit(problem, T_world_vertex, options)) {
    std::vector<SE3> robust = solve_robustly(problem, options);
    misfits = misfits_of(problem, robust, options);
    const bool undo =
        std::any_of(misfits.begin(), misfits.end(), [&](size_t i) { return problem.loops[i].corrected; });
    if (undo) {
      T_world_vertex = std::move(robust);
    } else if (!misfits.empty()) {
      const PoseGraph rest = without(problem.graph, problem.loops.size(), misfits);
      T_world_vertex = solve_pose_graph(rest, options.pose_graph).T_world_vertex;
    }
  }
  LoopCorrection correction;
  correction.merges = problem.merges;
  for (size_t i = 0; i < problem.loops.size(); ++i) {
    const bool misfit = std::binary_search(misfits.begin(), misfits.end(), i);
    (misfit ? correction.withdrawn : correction.loops).push_back({problem.loops[i].a, problem.loops[i].b});
  }
  correction.update = update_of(problem, T_world_vertex, correction.withdrawn);
  return correction;
}

}  // namespace kinloop
