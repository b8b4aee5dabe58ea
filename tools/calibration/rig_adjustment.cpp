#include "tools/calibration/rig_adjustment.hpp"

#include <array>
#include <cmath>
#include <memory>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <ceres/ceres.h>

#include "kinloop/core/errors.hpp"
#include "tools/calibration/board_residual.hpp"

namespace kinloop {
namespace {

constexpr std::array<int, kSharedBlocks> kBlockStarts = {0, 4, 6, 8, 9, 10, kLensParameters};

using CameraNumbers = std::array<double, kRigCameraParameters>;
using PoseNumbers = std::array<double, 6>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

PoseNumbers pack(const SE3& T) {
  const Eigen::Vector3d r = log_so3(T.rotation);
  return {T.translation.x(), T.translation.y(), T.translation.z(), r.x(), r.y(), r.z()};
}

SE3 unpack_pose(const double* x) {
  return {exp_so3({x[3], x[4], x[5]}), {x[0], x[1], x[2]}};
}

CameraNumbers pack(const RigCamera& camera) {
  CameraNumbers numbers{};
  Eigen::Map<Eigen::Matrix<double, kLensParameters, 1>>(numbers.data()) = lens_parameters(camera.lens);
  const PoseNumbers motion = pack(camera.T_camera_rig);
  std::copy(motion.begin(), motion.end(), numbers.begin() + kLensParameters);
  return numbers;
}

void unpack(const CameraNumbers& x, RigCamera& camera) {
  PinholeCamera& lens = camera.lens;
  lens.fx = x[0], lens.fy = x[1], lens.cx = x[2], lens.cy = x[3];
  lens.lens = {lens.lens.model, x[4], x[5], x[6], x[7], x[8], x[9], x[10], x[11]};
  camera.T_camera_rig = unpack_pose(x.data() + kLensParameters);
}

/// The estimated parameters, and which blocks are constant.
struct RigState {
  std::vector<CameraNumbers> cameras;
  std::vector<PoseNumbers> boards;
  std::vector<std::array<bool, kSharedBlocks>> held;

  [[nodiscard]] std::vector<double*> blocks(const BoardObservation& s) {
    double* camera = cameras[s.camera].data();
    std::vector<double*> all;
    for (const int start : kBlockStarts) all.push_back(camera + start);
    all.push_back(boards[s.shot].data());
    return all;
  }
};

/// Whether each block of a lens to be estimated is constant.
std::array<bool, kSharedBlocks> held_terms(LensModel model, int distortion_terms) {
  switch (model) {
    case LensModel::kRational:
      return {};
    case LensModel::kKannalaBrandt:
      return {false, false, true, false, false, true};
    case LensModel::kBrownConrady:
      break;
  }
  return {false, distortion_terms < 2, distortion_terms < 4, distortion_terms < 5, true, true};
}

RigState make_state(const RigProblem& problem, int distortion_terms) {
  RigState state;
  for (size_t c = 0; c < problem.cameras.size(); ++c) {
    const RigCamera& camera = problem.cameras[c];
    state.cameras.push_back(pack(camera));
    auto held = held_terms(camera.lens.lens.model, distortion_terms);
    if (camera.lens_fixed) held.fill(true);
    held.back() = c == 0 || camera.pose_fixed;
    state.held.push_back(held);
  }
  for (const SE3& T : problem.T_rig_board) state.boards.push_back(pack(T));
  return state;
}

std::unique_ptr<BoardCost> make_cost(const RigProblem& problem, const BoardObservation& sighting) {
  const RigCamera& camera = problem.cameras[sighting.camera];
  return std::make_unique<BoardCost>(
      new BoardResidual{&sighting.view, camera.sigma_px, camera.lens.lens.model},
      static_cast<int>(2 * sighting.view.pixels.size()));
}

bool minimize(const RigProblem& problem, RigState& state) {
  ceres::Problem least_squares;
  auto* order = new ceres::ParameterBlockOrdering;  // owned by the solver's options below
  for (const BoardObservation& s : problem.observations) {
    const auto blocks = state.blocks(s);
    least_squares.AddResidualBlock(make_cost(problem, s).release(), nullptr, blocks);
    for (int b = 0; b < kSharedBlocks; ++b) {
      if (state.held[s.camera][static_cast<size_t>(b)])
        least_squares.SetParameterBlockConstant(blocks[static_cast<size_t>(b)]);
      order->AddElementToGroup(blocks[static_cast<size_t>(b)], 1);
    }
    order->AddElementToGroup(blocks.back(), 0);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.linear_solver_ordering.reset(order);
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-12;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &least_squares, &summary);
  return summary.IsSolutionUsable() && summary.termination_type == ceres::CONVERGENCE;
}

/// Residuals of an observation, and their Jacobians with respect to all camera parameters (zero for constant
/// ones) and to its board pose.
struct ObservationRows {
  Eigen::VectorXd residuals;
  Columns shared, board;
};

ObservationRows rows_of(const RigProblem& problem, RigState& state, const BoardObservation& s) {
  const auto cost = make_cost(problem, s);
  const auto count = static_cast<Eigen::Index>(2 * s.view.pixels.size());
  std::array<Columns, kBlockSizes.size()> columns;
  std::array<double*, kBlockSizes.size()> places{};
  for (size_t b = 0; b < columns.size(); ++b) {
    columns[b].resize(count, kBlockSizes[b]);
    places[b] = columns[b].data();
  }
  ObservationRows rows;
  rows.residuals.resize(count);
  const auto blocks = state.blocks(s);
  cost->Evaluate(blocks.data(), rows.residuals.data(), places.data());
  rows.board = columns.back();
  rows.shared.setZero(count, static_cast<Eigen::Index>(state.cameras.size()) * kRigCameraParameters);
  const auto first = static_cast<Eigen::Index>(s.camera) * kRigCameraParameters;
  for (size_t b = 0; b < kSharedBlocks; ++b) {
    if (!state.held[s.camera][b]) {
      rows.shared.middleCols(first + kBlockStarts[b], kBlockSizes[b]) = columns[b];
    }
  }
  return rows;
}

/// Information of one shot about the camera parameters, with the board pose marginalised (Schur complement).
struct ShotInformation {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

std::vector<ShotInformation> shot_informations(const RigProblem& problem, RigState& state) {
  const auto count = static_cast<Eigen::Index>(state.cameras.size()) * kRigCameraParameters;
  std::vector<ShotInformation> shots(state.boards.size(),
                                     {Eigen::MatrixXd::Zero(count, count), Eigen::VectorXd::Zero(count)});
  std::vector<Eigen::MatrixXd> mixed(shots.size(), Eigen::MatrixXd::Zero(count, SE3::kDof));
  std::vector<Matrix6d> boards(shots.size(), Matrix6d::Zero());
  std::vector<Vector6d> board_gradients(shots.size(), Vector6d::Zero());
  for (const BoardObservation& s : problem.observations) {
    const ObservationRows rows = rows_of(problem, state, s);
    shots[s.shot].information += rows.shared.transpose() * rows.shared;
    shots[s.shot].gradient += rows.shared.transpose() * rows.residuals;
    mixed[s.shot] += rows.shared.transpose() * rows.board;
    boards[s.shot] += rows.board.transpose() * rows.board;
    board_gradients[s.shot] += rows.board.transpose() * rows.residuals;
  }
  for (size_t i = 0; i < shots.size(); ++i) {
    const auto board = boards[i].ldlt();
    shots[i].information -= mixed[i] * board.solve(mixed[i].transpose());
    shots[i].gradient -= mixed[i] * board.solve(board_gradients[i]);
  }
  return shots;
}

/// Inverse over the estimated parameters, zero for constant ones. Scaled before inversion, since the units of
/// the parameters range from pixels to 1. Undetermined directions get a very large variance.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& information) {
  constexpr double kMinValue = 1e-12;  // eigenvalue of the scaled matrix
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < information.rows(); ++i) {
    if (information(i, i) > 0) free.push_back(i);
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(information.rows(), information.cols());
  if (free.empty()) return covariance;
  const Eigen::VectorXd scale = information.diagonal()(free).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information(free, free) * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const Eigen::VectorXd inverse = eigen.eigenvalues().cwiseMax(kMinValue).cwiseInverse();
  const Eigen::MatrixXd axes = scale.asDiagonal() * eigen.eigenvectors();
  covariance(free, free) = axes * inverse.asDiagonal() * axes.transpose();
  return covariance;
}

/// If all errors were independent with the assumed deviation, a shot's gradient g would have the covariance
/// A_s - A_s C A_s (A_s its information, C the inverse of their sum). Returns how much larger g^T C g is,
/// over all shots.
double dispersion_of(const std::vector<ShotInformation>& shots, const Eigen::MatrixXd& C) {
  double found = 0, expected = 0;
  for (const auto& shot : shots) {
    const Eigen::MatrixXd share = C * shot.information;
    found += shot.gradient.dot(C * shot.gradient);
    expected += share.trace() - (share * share).trace();
  }
  return expected > 0 ? found / expected : 0;
}

}  // namespace

Eigen::Matrix<double, kLensParameters, 1> lens_parameters(const PinholeCamera& c) {
  Eigen::Matrix<double, kLensParameters, 1> numbers;
  const LensDistortion& d = c.lens;
  numbers << c.fx, c.fy, c.cx, c.cy, d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6;
  return numbers;
}

std::vector<int> parameters_of(LensModel model) {
  switch (model) {
    case LensModel::kRational:
      return {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    case LensModel::kKannalaBrandt:
      return {0, 1, 2, 3, 4, 5, 8, 9};
    case LensModel::kBrownConrady:
      break;
  }
  return {0, 1, 2, 3, 4, 5, 6, 7, 8};
}

std::vector<Eigen::Vector2d> reprojection_errors(const PinholeCamera& camera, const SE3& T_camera_board,
                                                 const BoardView& view) {
  std::vector<Eigen::Vector2d> errors;
  for (size_t i = 0; i < view.pixels.size(); ++i) {
    const Eigen::Vector3d p = T_camera_board * Eigen::Vector3d(view.board_m[i].x(), view.board_m[i].y(), 0);
    errors.emplace_back(camera.distort(camera.project(p)) - view.pixels[i]);
  }
  return errors;
}

double rms_px(const std::vector<Eigen::Vector2d>& errors) {
  double sum = 0;
  for (const auto& e : errors) sum += e.squaredNorm();
  return errors.empty() ? 0 : std::sqrt(sum / static_cast<double>(errors.size()));
}

RigSolution adjust_rig(const RigProblem& problem, int distortion_terms) {
  require(!problem.cameras.empty() && !problem.observations.empty(),
          "adjust_rig: needs a camera and an observation");
  RigState state = make_state(problem, distortion_terms);
  RigSolution solution;
  solution.cameras = problem.cameras;
  solution.converged = minimize(problem, state);
  for (size_t c = 0; c < state.cameras.size(); ++c) unpack(state.cameras[c], solution.cameras[c]);
  for (const PoseNumbers& board : state.boards) solution.T_rig_board.push_back(unpack_pose(board.data()));
  const auto shots = shot_informations(problem, state);
  Eigen::MatrixXd information =
      Eigen::MatrixXd::Zero(shots.front().information.rows(), shots.front().information.cols());
  for (const auto& shot : shots) information += shot.information;
  solution.covariance = covariance_of(information);
  solution.dispersion = dispersion_of(shots, solution.covariance);
  return solution;
}

}  // namespace kinloop
