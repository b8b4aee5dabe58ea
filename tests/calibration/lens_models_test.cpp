#include <algorithm>
#include <array>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "tests/calibration/synthetic_boards.hpp"
#include "tools/calibration/lens.hpp"

namespace kinloop {
namespace {

using test::small_board;

/// The largest distance, within the area of the corners, of the pixels of a ray by two cameras.
double largest_difference_px(const PinholeCamera& a, const PinholeCamera& b, double max_radius) {
  double largest = 0;
  for (double x = -max_radius; x <= max_radius; x += max_radius / 10) {
    for (double y = -max_radius; y <= max_radius; y += max_radius / 10) {
      if (std::hypot(x, y) > max_radius) continue;
      const Eigen::Vector3d p(x, y, 1);
      largest = std::max(largest, (a.distort(a.project(p)) - b.distort(b.project(p))).norm());
    }
  }
  return largest;
}

PinholeCamera azure_camera() {
  PinholeCamera c;
  c.width = 640, c.height = 576, c.fx = 503.9, c.fy = 504, c.cx = 332, c.cy = 326;
  c.lens = {LensModel::kRational,
            3.1305770,
            2.3249390,
            8.1e-05,
            -5.1e-05,
            0.1304156,
            3.4586515,
            3.3501145,
            0.6629416};
  return c;
}

/// 160 degrees over the width.
PinholeCamera fisheye_camera() {
  PinholeCamera c;
  c.width = 1280, c.height = 960, c.fx = 458, c.fy = 459, c.cx = 644, c.cy = 478;
  c.lens = lens_with(LensModel::kKannalaBrandt, std::array{-0.0065, 0.0421, -0.0396, 0.0069});
  return c;
}

/// Near views over most of a wide image.
std::vector<BoardView> wide_views(const PinholeCamera& camera, int count, double sigma_px, uint64_t seed) {
  Random random(seed);
  std::vector<BoardView> views;
  while (views.size() < static_cast<size_t>(count)) {
    const double z = random.uniform(0.15, 0.4), tilt = 0.6;
    const Eigen::Vector3d middle(random.uniform(-0.3, 0.3), random.uniform(-0.25, 0.25), z);
    const Eigen::Vector3d turn(random.uniform(-tilt, tilt), random.uniform(-tilt, tilt),
                               random.uniform(-0.3, 0.3));
    BoardView view = test::view_of(camera, test::board_at(middle, turn, small_board()), small_board(),
                                   fmt::format("view{}", views.size()));
    const bool inside = std::all_of(view.pixels.begin(), view.pixels.end(),
                                    [&](const Eigen::Vector2d& pixel) { return camera.contains(pixel, 5); });
    if (!inside) continue;
    test::add_noise(view, sigma_px, random);
    views.push_back(std::move(view));
  }
  return views;
}

CalibrationOptions options_for(LensModel model) {
  CalibrationOptions options;
  options.lens_model = model;
  return options;
}

TEST(CalibrateLens, FindsARationalLens) {
  const PinholeCamera truth = azure_camera();
  const LensCalibration exact =
      calibrate_lens(wide_views(truth, 20, 0, 11), options_for(LensModel::kRational));
  EXPECT_LT(exact.rms_px, 1e-3);
  EXPECT_LT(largest_difference_px(exact.camera, truth, 0.6), 0.05);
  const LensCalibration noisy =
      calibrate_lens(wide_views(truth, 30, 0.1, 12), options_for(LensModel::kRational));
  EXPECT_NEAR(noisy.sigma_px, 0.1, 0.01);
  EXPECT_LT(largest_difference_px(noisy.camera, truth, 0.6), 1);
  EXPECT_EQ(noisy.camera.lens.model, LensModel::kRational);
}

TEST(CalibrateLens, FindsAFisheyeLens) {
  const PinholeCamera truth = fisheye_camera();
  const LensCalibration exact =
      calibrate_lens(wide_views(truth, 20, 0, 13), options_for(LensModel::kKannalaBrandt));
  EXPECT_LT((lens_parameters(exact.camera) - lens_parameters(truth)).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT(exact.rms_px, 1e-6);
  const LensCalibration noisy =
      calibrate_lens(wide_views(truth, 30, 0.1, 14), options_for(LensModel::kKannalaBrandt));
  EXPECT_NEAR(noisy.sigma_px, 0.1, 0.01);
  const std::vector<int> estimated = parameters_of(LensModel::kKannalaBrandt);
  const Eigen::VectorXd error = (lens_parameters(noisy.camera) - lens_parameters(truth))(estimated);
  const Eigen::MatrixXd covariance = noisy.covariance(estimated, estimated);
  constexpr double kRare = 31.8;  // chi-squared with 8 degrees of freedom exceeds it once in 10,000
  EXPECT_LT(error.dot(covariance.ldlt().solve(error)), kRare);
  EXPECT_EQ(noisy.camera.lens.p1, 0);
  EXPECT_EQ(noisy.std_deviations()(6), 0);  // p1
}

TEST(CalibrateLens, AFisheyeLensAgreesWithOpenCvOnTheSameCorners) {
  const auto views = wide_views(fisheye_camera(), 20, 0.1, 15);
  std::vector<std::vector<cv::Point3d>> points;
  std::vector<std::vector<cv::Point2d>> pixels;
  for (const auto& view : views) {
    points.emplace_back(), pixels.emplace_back();
    for (size_t i = 0; i < view.pixels.size(); ++i) {
      points.back().emplace_back(view.board_m[i].x(), view.board_m[i].y(), 0);
      pixels.back().emplace_back(view.pixels[i].x(), view.pixels[i].y());
    }
  }
  cv::Matx33d K;
  cv::Vec4d D;
  std::vector<cv::Mat> rotations, translations;
  const cv::TermCriteria until(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 200, 1e-12);
  cv::fisheye::calibrate(points, pixels, {1280, 960}, K, D, rotations, translations,
                         cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW, until);
  const LensCalibration c = calibrate_lens(views, options_for(LensModel::kKannalaBrandt));
  EXPECT_NEAR(c.camera.fx, K(0, 0), 0.05);
  EXPECT_NEAR(c.camera.cy, K(1, 2), 0.05);
  EXPECT_NEAR(c.camera.lens.k1, D[0], 1e-3);
}

}  // namespace
}  // namespace kinloop
