#include "kinloop/optimize/pose_graph/chordal_initialization.hpp"

#include <Eigen/SVD>

#include "kinloop/optimize/pose_graph/pose_graph_error.hpp"

namespace kinloop {
namespace {

template <class Pose>
constexpr int kDim = Pose::kDof == 6 ? 3 : 2;  // dimension of the space

template <class Pose>
using Square = Eigen::Matrix<double, kDim<Pose>, kDim<Pose>>;

Eigen::Quaterniond nearest_rotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
  return Eigen::Quaterniond(Eigen::Matrix3d(U * svd.matrixV().transpose())).normalized();
}

void set_rotation(SE3& T, const Eigen::Matrix3d& M) {
  T.rotation = nearest_rotation(M);
}

void set_rotation(SE2& T, const Eigen::Matrix2d& M) {
  T.angle_rad = std::atan2(M(1, 0) - M(0, 1), M(0, 0) + M(1, 1));
}

/// A linear least squares problem over edges, with the pattern of the pose graph and blocks of the size of
/// the space.
template <class Pose>
struct LinearProblem {
  static constexpr int kD = kDim<Pose>;
  BlockMatrix<kD> H;
  Eigen::MatrixXd right;

  LinearProblem(const BlockPattern& pattern, int columns)
      : H(pattern), right(Eigen::MatrixXd::Zero(kD * static_cast<Eigen::Index>(pattern.size), columns)) {}

  /// |x_b - A x_a - c|^2_W between blocks a and b, where A is orthogonal. A fixed vertex has the value
  /// `held_a` or `held_b`.
  template <class Value>
  struct Term {
    uint32_t a, b;
    Square<Pose> A, W;
    Value c, held_a, held_b;
  };

  /// Adds the term of edge `i`.
  template <class Value>
  void add(const PoseGraphLayout& layout, size_t i, const Term<Value>& term) {
    const auto& [a, b, A, W, c, held_a, held_b] = term;
    const Square<Pose> WA = W * A;
    if (a != kNoBlock) {
      H.diagonal[a] += A.transpose() * WA;
      right.middleRows<kD>(kD * a) -= WA.transpose() * (b == kNoBlock ? Value(c - held_b) : c);
    }
    if (b != kNoBlock) {
      H.diagonal[b] += W;
      right.middleRows<kD>(kD * b) += W * (a == kNoBlock ? Value(c + A * held_a) : c);
    }
    if (a == kNoBlock || b == kNoBlock) return;
    Square<Pose>& slot = H.off_diagonal[layout.slot_of_edge[i]];
    if (b > a) {
      slot -= WA;
    } else {
      slot -= WA.transpose();
    }
  }

  std::optional<Eigen::MatrixXd> solve(const EliminationPlan& plan) const {
    SparseCholesky<kD> cholesky(plan);
    if (!cholesky.factorize(H)) return {};
    Eigen::MatrixXd x = cholesky.solve(right);
    if (!x.allFinite()) return {};
    return x;
  }
};

uint32_t block_of(const PoseGraphLayout& layout, uint32_t vertex) {
  return vertex == kWorld ? kNoBlock : layout.block_of_vertex[vertex];
}

/// Rotations that minimise sum w |R_b - R_a R_a_b|^2. The unknowns are R', so that each block has one factor
/// on its left.
template <class Pose>
bool solve_rotations(const BasicPoseGraph<Pose>& graph, const PoseGraphLayout& layout,
                     const EliminationPlan& plan, std::vector<Pose>& T_world_vertex) {
  constexpr int kD = kDim<Pose>;
  constexpr int kAngles = Pose::kDof - kD;
  LinearProblem<Pose> problem(layout.pattern, kD);
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const auto& edge = graph.edges[i];
    const double weight = edge.information.template bottomRightCorner<kAngles, kAngles>().trace() / kAngles;
    const Square<Pose> W = weight * Square<Pose>::Identity();
    problem.template add<Square<Pose>>(
        layout, i,
        {block_of(layout, edge.a), layout.block_of_vertex[edge.b], edge.T_a_b.R().transpose(), W,
         Square<Pose>::Zero(), pose_of_a(T_world_vertex, edge).R().transpose(),
         T_world_vertex[edge.b].R().transpose()});
  }
  const auto x = problem.solve(plan);
  if (!x) return false;
  for (size_t vertex = 0; vertex < T_world_vertex.size(); ++vertex) {
    const uint32_t block = layout.block_of_vertex[vertex];
    if (block == kNoBlock) continue;
    set_rotation(T_world_vertex[vertex],
                 Square<Pose>(x->template middleRows<kD>(static_cast<Eigen::Index>(kD) * block).transpose()));
  }
  return true;
}

/// Translations that minimise chi2 for given rotations: e_t = S (t_b - t_a - R_a t_a_b), S = (R_a R_a_b)'.
template <class Pose>
bool solve_translations(const BasicPoseGraph<Pose>& graph, const PoseGraphLayout& layout,
                        const EliminationPlan& plan, std::vector<Pose>& T_world_vertex) {
  constexpr int kD = kDim<Pose>;
  LinearProblem<Pose> problem(layout.pattern, 1);
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const auto& edge = graph.edges[i];
    const Pose T_world_a = pose_of_a(T_world_vertex, edge);
    const Square<Pose> R_a = T_world_a.R();
    const Square<Pose> S = (R_a * edge.T_a_b.R()).transpose();
    const Square<Pose> W = S.transpose() * edge.information.template topLeftCorner<kD, kD>() * S;
    using Vector = Eigen::Matrix<double, kD, 1>;
    problem.template add<Vector>(
        layout, i,
        {block_of(layout, edge.a), layout.block_of_vertex[edge.b], Square<Pose>::Identity(), W,
         R_a * edge.T_a_b.translation, T_world_a.translation, T_world_vertex[edge.b].translation});
  }
  const auto x = problem.solve(plan);
  if (!x) return false;
  for (size_t vertex = 0; vertex < T_world_vertex.size(); ++vertex) {
    const uint32_t block = layout.block_of_vertex[vertex];
    if (block == kNoBlock) continue;
    T_world_vertex[vertex].translation = x->template middleRows<kD>(static_cast<Eigen::Index>(kD) * block);
  }
  return true;
}

}  // namespace

template <class Pose>
std::optional<std::vector<Pose>> chordal_initialization(const BasicPoseGraph<Pose>& graph,
                                                        const PoseGraphLayout& layout,
                                                        const EliminationPlan& plan) {
  std::vector<Pose> T_world_vertex = graph.T_world_vertex;
  if (!solve_rotations(graph, layout, plan, T_world_vertex)) return {};
  if (!solve_translations(graph, layout, plan, T_world_vertex)) return {};
  return T_world_vertex;
}

template std::optional<std::vector<SE3>> chordal_initialization(const PoseGraph&, const PoseGraphLayout&,
                                                                const EliminationPlan&);
template std::optional<std::vector<SE2>> chordal_initialization(const PoseGraph2d&, const PoseGraphLayout&,
                                                                const EliminationPlan&);

}  // namespace kinloop
