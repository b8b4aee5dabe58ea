#include "tools/calibration/lens.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/quantile.hpp"
#include "tools/calibration/board/homography.hpp"

namespace kinloop {
namespace {

constexpr size_t kMinViews = 3;

/// Views with the homography of each; views without one (all corners collinear) are left out.
struct PlanarViews {
  std::vector<BoardView> views;
  std::vector<Eigen::Matrix3d> homographies;
};

PlanarViews planar(const std::vector<BoardView>& views, std::vector<RejectedView>& rejected) {
  PlanarViews planar;
  for (const BoardView& view : views) {
    const auto H = fit_homography(view.board_m, view.pixels);
    if (!H) {
      rejected.push_back({view.name, "its corners are collinear"});
      continue;
    }
    planar.views.push_back(view);
    planar.homographies.push_back(*H);
  }
  return planar;
}

void require_enough_views(size_t views) {
  if (views >= kMinViews) return;
  throw InputError(
      fmt::format("only {} usable views of the board; calibration needs at least {}, better about "
                  "twenty, with the "
                  "board tilted differently in each",
                  views, kMinViews));
}

RigProblem rig_of(const PinholeCamera& lens, const std::vector<SE3>& poses,
                  const std::vector<BoardView>& views) {
  RigProblem problem;
  problem.cameras.push_back({lens, {}, 1, false});
  problem.T_rig_board = poses;
  for (size_t i = 0; i < views.size(); ++i) problem.observations.push_back({0, i, views[i]});
  return problem;
}

std::vector<FittedView> fitted(const PinholeCamera& lens, const std::vector<SE3>& poses,
                               const std::vector<BoardView>& views) {
  std::vector<FittedView> fits;
  for (size_t i = 0; i < views.size(); ++i) {
    auto errors = reprojection_errors(lens, poses[i], views[i]);
    const double rms = rms_px(errors);
    fits.push_back({views[i], poses[i], std::move(errors), rms});
  }
  return fits;
}

double rms_of_all(const std::vector<FittedView>& fits) {
  std::vector<Eigen::Vector2d> all;
  for (const auto& fit : fits) all.insert(all.end(), fit.errors_px.begin(), fit.errors_px.end());
  return rms_px(all);
}

/// The view that agrees least with the rest, if it is an outlier.
std::optional<size_t> outlier(const std::vector<FittedView>& fits, double factor) {
  std::vector<double> rms;
  for (const auto& fit : fits) rms.push_back(fit.rms_px);
  const auto worst = std::max_element(rms.begin(), rms.end());
  constexpr double kExactPx = 1e-6;  // below, all views are error-free
  if (*worst <= factor * median(rms) || *worst < kExactPx) return std::nullopt;
  return static_cast<size_t>(worst - rms.begin());
}

/// Size of a set of boards in which no two tilts are alike, found greedily.
size_t distinct_tilts(const std::vector<FittedView>& fits, double alike_deg) {
  const double alike_cos = std::cos(alike_deg * std::numbers::pi / 180);
  std::vector<Eigen::Vector3d> normals;
  for (const auto& fit : fits) {
    const Eigen::Vector3d normal = fit.T_camera_board.R().col(2);
    const bool fresh = std::none_of(normals.begin(), normals.end(), [&](const auto& other) {
      return std::abs(normal.dot(other)) > alike_cos;
    });
    if (fresh) normals.push_back(normal);
  }
  return normals.size();
}

ImageCoverage compute_coverage(const std::vector<FittedView>& fits) {
  std::array<bool, static_cast<size_t>(ImageCoverage::kColumns) * ImageCoverage::kRows> seen{};
  ImageCoverage coverage;
  for (const auto& [view, T, errors, rms] : fits) {
    const Eigen::Vector2d size(view.width, view.height), middle = (size.array() - 1) / 2;
    for (const auto& pixel : view.pixels) {
      const int column = std::clamp(static_cast<int>(pixel.x() / size.x() * ImageCoverage::kColumns), 0,
                                    ImageCoverage::kColumns - 1);
      const int row = std::clamp(static_cast<int>(pixel.y() / size.y() * ImageCoverage::kRows), 0,
                                 ImageCoverage::kRows - 1);
      seen[static_cast<size_t>(row) * ImageCoverage::kColumns + static_cast<size_t>(column)] = true;
      coverage.radius_share = std::max(coverage.radius_share, (pixel - middle).norm() / middle.norm());
    }
  }
  coverage.cells_share =
      static_cast<double>(std::count(seen.begin(), seen.end(), true)) / static_cast<double>(seen.size());
  return coverage;
}

std::vector<std::string> warnings_of(const LensCalibration& c, const CalibrationOptions& options) {
  constexpr size_t kGoodTilts = 4, kGoodViews = 10;
  constexpr double kGoodShare = 0.6, kGoodFocal = 0.01;
  std::vector<std::string> warnings;
  if (c.distinct_tilts < kGoodTilts) {
    warnings.push_back(
        fmt::format("the views are too alike: only {} tilts of the board differ by {} degrees or more; "
                    "tilt it more, to all sides",
                    c.distinct_tilts, options.min_tilt_difference_deg));
  }
  if (c.views.size() < kGoodViews) {
    warnings.push_back(fmt::format("only {} views; take at least {}", c.views.size(), kGoodViews));
  }
  if (c.coverage.cells_share < kGoodShare) {
    warnings.push_back(
        fmt::format("corners cover only {:.0f} % of the image; hold the board closer and into its "
                    "corners",
                    100 * c.coverage.cells_share));
  }
  const double focal_share =
      std::max(c.std_deviations()(0) / c.camera.fx, c.std_deviations()(1) / c.camera.fy);
  if (focal_share > kGoodFocal) {
    warnings.push_back(
        fmt::format("the stills do not constrain the focal length: its standard deviation is {:.1f} %",
                    100 * focal_share));
  }
  return warnings;
}

/// Standard deviation of one coordinate: squared errors over degrees of freedom.
double sigma_of(const std::vector<FittedView>& fits, int lens_parameters) {
  double sum = 0, freedom = -lens_parameters;
  for (const auto& fit : fits) {
    for (const auto& e : fit.errors_px) sum += e.squaredNorm();
    freedom += 2 * static_cast<double>(fit.errors_px.size()) - SE3::kDof;
  }
  return freedom > 0 ? std::sqrt(sum / freedom) : 0;
}

/// A camera and the poses of the boards to begin the refinement with.
struct InitialSolution {
  PinholeCamera camera;
  std::vector<SE3> poses;
};

/// The equidistant lens with the image's centre whose focal length, of some, fits the views best.
InitialSolution initial_fisheye(const std::vector<BoardView>& views) {
  constexpr double kLeastShare = 0.15, kMostShare = 1.5, kRatio = 1.06;  // focal length per width
  InitialSolution best;
  double best_rms_px = std::numeric_limits<double>::infinity();
  PinholeCamera camera;
  camera.width = views.front().width, camera.height = views.front().height;
  camera.cx = (camera.width - 1) / 2.0, camera.cy = (camera.height - 1) / 2.0;
  camera.lens.model = LensModel::kKannalaBrandt;
  for (double share = kLeastShare; share < kMostShare; share *= kRatio) {
    camera.fx = camera.fy = share * camera.width;
    std::vector<SE3> poses;
    for (const BoardView& view : views) {
      if (const auto pose = board_pose(camera, view)) poses.push_back(*pose);
    }
    if (poses.size() < views.size()) continue;
    const double rms = rms_of_all(fitted(camera, poses, views));
    if (rms < best_rms_px) best = {camera, poses}, best_rms_px = rms;
  }
  if (best.poses.empty()) throw InputError("no fisheye lens fits the views; check the size of the board");
  return best;
}

InitialSolution initial_pinhole(const PlanarViews& planar) {
  const BoardView& first = planar.views.front();
  const auto closed = camera_from_homographies(planar.homographies, first.width, first.height);
  if (!closed) {
    throw InputError(fmt::format(
        "the {} views do not determine the camera: the boards are parallel to each other or to the "
        "image; tilt the board "
        "by 20 to 45 degrees, in a different direction in each view",
        planar.views.size()));
  }
  InitialSolution initial{*closed, {}};
  for (const auto& H : planar.homographies) initial.poses.push_back(pose_from_homography(*closed, H));
  return initial;
}

RigSolution refined(const InitialSolution& initial, const std::vector<BoardView>& views,
                    int distortion_terms) {
  RigSolution solution = adjust_rig(rig_of(initial.camera, initial.poses, views), distortion_terms);
  if (solution.converged) return solution;
  throw InputError("the optimisation did not converge; take more views with the board tilted differently");
}

int estimated_parameters(const CalibrationOptions& options) {
  if (options.lens_model == LensModel::kBrownConrady) return 4 + options.distortion_terms;
  return static_cast<int>(parameters_of(options.lens_model).size());
}

/// Initial solution and refinement for the current views.
void solve(LensCalibration& c, const PlanarViews& planar, const CalibrationOptions& options) {
  const bool fisheye = options.lens_model == LensModel::kKannalaBrandt;
  const InitialSolution initial = fisheye ? initial_fisheye(planar.views) : initial_pinhole(planar);
  RigSolution solution = refined(initial, planar.views, options.distortion_terms);
  if (options.lens_model == LensModel::kRational) {
    PinholeCamera camera = solution.cameras.front().lens;
    camera.lens.model = LensModel::kRational;
    solution = refined({camera, solution.T_rig_board}, planar.views, options.distortion_terms);
  }
  c.closed_form = initial.camera;
  c.closed_form_rms_px = rms_of_all(fitted(initial.camera, initial.poses, planar.views));
  c.camera = solution.cameras.front().lens;
  c.views = fitted(c.camera, solution.T_rig_board, planar.views);
  c.rms_px = rms_of_all(c.views);
  c.sigma_px = sigma_of(c.views, estimated_parameters(options));
  c.sigma_inflation = c.sigma_px > 0 ? std::max(1.0, std::sqrt(solution.dispersion) / c.sigma_px) : 1;
  c.covariance = solution.covariance.topLeftCorner<kLensParameters, kLensParameters>() *
                 std::pow(c.sigma_px * c.sigma_inflation, 2);
}

}  // namespace

LensCalibration calibrate_lens(const std::vector<BoardView>& views, const CalibrationOptions& options) {
  check_options(options);
  LensCalibration c;
  PlanarViews used = planar(views, c.rejected);
  while (true) {
    require_enough_views(used.views.size());
    solve(c, used, options);
    const auto worst = outlier(c.views, options.outlier_factor);
    if (!worst || used.views.size() == kMinViews) break;
    const FittedView& view = c.views[*worst];
    c.rejected.push_back(
        {view.view.name, fmt::format("RMS {:.2f} px, overall {:.2f} px", view.rms_px, c.rms_px)});
    used.views.erase(used.views.begin() + static_cast<std::ptrdiff_t>(*worst));
    used.homographies.erase(used.homographies.begin() + static_cast<std::ptrdiff_t>(*worst));
  }
  c.distinct_tilts = distinct_tilts(c.views, options.min_tilt_difference_deg);
  c.coverage = compute_coverage(c.views);
  c.warnings = warnings_of(c, options);
  return c;
}

}  // namespace kinloop
