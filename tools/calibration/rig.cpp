#include "tools/calibration/rig.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "tools/calibration/board/homography.hpp"

namespace kinloop {
namespace {

constexpr size_t kInfrared = 0, kColor = 1;  // cameras of the rig; the first is its origin
constexpr size_t kMinPairs = 2;

/// A camera before the joint adjustment: its lens, and which of its images are usable.
struct InitialLens {
  PinholeCamera lens;
  bool known = false;
  double sigma_px = 1;
  std::vector<BoardView> stills;
  std::set<std::string> rejected;
};

InitialLens start_of(const LensSource& source, std::vector<BoardView> paired,
                     const CalibrationOptions& options, std::optional<LensCalibration>& alone,
                     std::vector<RejectedView>& rejected) {
  InitialLens start;
  start.known = source.known.has_value();
  if (start.known) {
    start.lens = *source.known;
    return start;
  }
  std::vector<BoardView> all = source.stills;
  all.insert(all.end(), paired.begin(), paired.end());
  alone = calibrate_lens(all, options);
  start.lens = alone->camera;
  start.sigma_px = alone->sigma_px;
  for (const RejectedView& view : alone->rejected) {
    start.rejected.insert(view.name);
    rejected.push_back(view);
  }
  for (const BoardView& view : source.stills) {
    if (!start.rejected.contains(view.name)) start.stills.push_back(view);
  }
  return start;
}

/// The colour view in the board orientation that minimises the rotation between the cameras, and the
/// resulting motion.
struct OrientedPair {
  BoardView color, infrared;
  SE3 T_infrared_board, T_color_infrared;
};

std::optional<OrientedPair> read_pair(const PairedView& pair, const InitialLens& color,
                                      const InitialLens& infrared, const Board& board) {
  const auto T_infrared_board = board_pose(infrared.lens, pair.infrared);
  if (!T_infrared_board) return std::nullopt;
  std::optional<OrientedPair> best;
  for (const bool turned : {false, true}) {
    if (turned && !board.has_180_degree_symmetry()) continue;
    const BoardView view = turned ? rotated_180(pair.color, board) : pair.color;
    const auto T_color_board = board_pose(color.lens, view);
    if (!T_color_board) continue;
    const SE3 T_color_infrared = *T_color_board * T_infrared_board->inverse();
    if (best && best->T_color_infrared.angle_rad() <= T_color_infrared.angle_rad()) continue;
    best = OrientedPair{view, pair.infrared, *T_infrared_board, T_color_infrared};
  }
  return best;
}

/// The motion of the pair that is closest to those of all others; a metre counts as much as a radian.
SE3 medoid(const std::vector<OrientedPair>& pairs) {
  const auto distance_to_all = [&](const SE3& T) {
    double sum = 0;
    for (const OrientedPair& other : pairs) sum += (T.inverse() * other.T_color_infrared).log().norm();
    return sum;
  };
  return std::min_element(pairs.begin(), pairs.end(),
                          [&](const OrientedPair& a, const OrientedPair& b) {
                            return distance_to_all(a.T_color_infrared) < distance_to_all(b.T_color_infrared);
                          })
      ->T_color_infrared;
}

void add_stills(RigProblem& problem, const InitialLens& start, size_t camera) {
  for (const BoardView& view : start.stills) {
    const auto T_camera_board = board_pose(start.lens, view);
    if (!T_camera_board) continue;
    problem.observations.push_back({camera, problem.T_rig_board.size(), view});
    problem.T_rig_board.push_back(problem.cameras[camera].T_camera_rig.inverse() * *T_camera_board);
  }
}

/// Pairs come first: shot i is pair i.
RigProblem make_problem(const std::vector<OrientedPair>& pairs, const InitialLens& color,
                        const InitialLens& infrared, const std::optional<SE3>& T_color_infrared) {
  RigProblem problem;
  problem.cameras.push_back({infrared.lens, {}, infrared.sigma_px, infrared.known, true});
  problem.cameras.push_back({color.lens, T_color_infrared ? *T_color_infrared : medoid(pairs), color.sigma_px,
                             color.known, T_color_infrared.has_value()});
  for (size_t i = 0; i < pairs.size(); ++i) {
    problem.T_rig_board.push_back(pairs[i].T_infrared_board);
    problem.observations.push_back({kInfrared, i, pairs[i].infrared});
    problem.observations.push_back({kColor, i, pairs[i].color});
  }
  add_stills(problem, infrared, kInfrared);
  add_stills(problem, color, kColor);
  return problem;
}

std::vector<FittedPair> fitted(const std::vector<OrientedPair>& pairs, const RigSolution& solution) {
  std::vector<FittedPair> fits;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const SE3& T_infrared_board = solution.T_rig_board[i];
    const RigCamera &infrared = solution.cameras[kInfrared], &color = solution.cameras[kColor];
    fits.push_back(
        {pairs[i].color.name, T_infrared_board,
         rms_px(reprojection_errors(color.lens, color.T_camera_rig * T_infrared_board, pairs[i].color)),
         rms_px(reprojection_errors(infrared.lens, T_infrared_board, pairs[i].infrared))});
  }
  return fits;
}

/// Normalised error of both images.
double misfit(const FittedPair& pair, const RigProblem& problem) {
  return std::hypot(pair.color_rms_px / problem.cameras[kColor].sigma_px,
                    pair.infrared_rms_px / problem.cameras[kInfrared].sigma_px);
}

/// The pair that agrees least with the rest, if it is an outlier.
std::optional<size_t> outlier(const std::vector<FittedPair>& fits, const RigProblem& problem, double factor) {
  std::vector<double> misfits;
  for (const FittedPair& fit : fits) misfits.push_back(misfit(fit, problem));
  auto sorted = misfits;
  std::sort(sorted.begin(), sorted.end());
  if (sorted.back() <= factor * sorted[sorted.size() / 2]) return std::nullopt;
  return static_cast<size_t>(std::max_element(misfits.begin(), misfits.end()) - misfits.begin());
}

void require_enough_pairs(size_t pairs) {
  if (pairs >= kMinPairs) return;
  throw InputError(
      fmt::format("only {} usable pairs; the transform between the cameras needs at least {} shots in which "
                  "both see the whole board",
                  pairs, kMinPairs));
}

/// Copies the result of the adjustment. With a known lens its sigma is a guess, so the overall error level is
/// always estimated from the errors.
void take(RigCalibration& rig, const RigSolution& solution, const RigProblem& problem) {
  rig.infrared = solution.cameras[kInfrared].lens;
  rig.color = solution.cameras[kColor].lens;
  rig.T_color_infrared = solution.cameras[kColor].T_camera_rig;
  double sum = 0, freedom = 0;
  for (const BoardObservation& s : problem.observations) {
    const RigCamera& camera = solution.cameras[s.camera];
    for (const auto& e :
         reprojection_errors(camera.lens, camera.T_camera_rig * solution.T_rig_board[s.shot], s.view)) {
      sum += e.squaredNorm() / std::pow(camera.sigma_px, 2);
      freedom += 2;
    }
  }
  freedom -= static_cast<double>(solution.T_rig_board.size()) * SE3::kDof + SE3::kDof;
  const double variance = freedom > 0 ? sum / freedom : 0;
  rig.sigma_inflation = variance > 0 ? std::sqrt(std::max(1.0, solution.dispersion / variance)) : 1;
  const Eigen::MatrixXd covariance = solution.covariance * variance * std::pow(rig.sigma_inflation, 2);
  constexpr int kColorFirst = kRigCameraParameters;
  rig.infrared_covariance = covariance.topLeftCorner<kLensParameters, kLensParameters>();
  rig.color_covariance = covariance.block<kLensParameters, kLensParameters>(kColorFirst, kColorFirst);
  rig.extrinsics_covariance = covariance.bottomRightCorner<6, 6>();
}

}  // namespace

RigCalibration calibrate_rig(const std::vector<PairedView>& pairs, const LensSource& color,
                             const LensSource& infrared, const Board& board,
                             const CalibrationOptions& options, const std::optional<SE3>& T_color_infrared) {
  check_options(options);
  RigCalibration rig;
  std::vector<BoardView> color_views, infrared_views;
  for (const PairedView& pair : pairs) {
    color_views.push_back(pair.color);
    infrared_views.push_back(pair.infrared);
  }
  require_enough_pairs(pairs.size());
  const InitialLens color_start = start_of(color, color_views, options, rig.color_alone, rig.rejected);
  const InitialLens infrared_start =
      start_of(infrared, infrared_views, options, rig.infrared_alone, rig.rejected);
  std::vector<OrientedPair> used;
  for (const PairedView& pair : pairs) {
    if (color_start.rejected.contains(pair.color.name) ||
        infrared_start.rejected.contains(pair.infrared.name))
      continue;
    if (auto read = read_pair(pair, color_start, infrared_start, board)) used.push_back(std::move(*read));
  }
  while (true) {
    require_enough_pairs(used.size());
    const RigProblem problem = make_problem(used, color_start, infrared_start, T_color_infrared);
    const RigSolution solution = adjust_rig(problem, options.distortion_terms);
    if (!solution.converged)
      throw InputError("the optimisation of both cameras did not converge; take more pairs");
    rig.pairs = fitted(used, solution);
    take(rig, solution, problem);
    const auto worst = outlier(rig.pairs, problem, options.outlier_factor);
    if (!worst || used.size() == kMinPairs) return rig;
    rig.rejected.push_back(
        {rig.pairs[*worst].name,
         fmt::format("disagrees with the transform of the other pairs: RMS {:.2f} px in colour, "
                     "{:.2f} px in infrared",
                     rig.pairs[*worst].color_rms_px, rig.pairs[*worst].infrared_rms_px)});
    used.erase(used.begin() + static_cast<std::ptrdiff_t>(*worst));
  }
}

}  // namespace kinloop
