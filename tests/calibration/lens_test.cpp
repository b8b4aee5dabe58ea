#include "tools/calibration/lens.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "tests/calibration/synthetic_boards.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::color_camera;
using test::input_error;
using test::random_views;
using test::small_board;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

TEST(CalibrateLens, FindsTheCameraWithoutNoise) {
  const LensCalibration c = calibrate_lens(random_views(color_camera(), 15, 0, 1));
  EXPECT_LT((lens_parameters(c.camera) - lens_parameters(color_camera())).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT(c.rms_px, 1e-7);
  EXPECT_THAT(c.rejected, testing::IsEmpty());
}

TEST(CalibrateLens, RefinementBeatsTheClosedForm) {
  const LensCalibration c = calibrate_lens(random_views(color_camera(), 15, 0.2, 2));
  EXPECT_LT(c.rms_px, c.closed_form_rms_px / 1.2);
  EXPECT_LT(std::abs(c.camera.fx - color_camera().fx), std::abs(c.closed_form.fx - color_camera().fx));
}

TEST(CalibrateLens, EstimatesTheNoise) {
  EXPECT_NEAR(calibrate_lens(random_views(color_camera(), 30, 0.25, 3)).sigma_px, 0.25, 0.02);
}

TEST(CalibrateLens, TheErrorGrowsInProportionToTheNoise) {
  const auto mean_error = [](double sigma_px) {
    double sum = 0;
    for (uint64_t seed = 0; seed < 10; ++seed) {
      sum += std::abs(calibrate_lens(random_views(color_camera(), 12, sigma_px, seed)).camera.fx -
                      color_camera().fx);
    }
    return sum / 10;
  };
  const double small = mean_error(0.05), large = mean_error(0.2);
  EXPECT_GT(large / small, 3.0);
  EXPECT_LT(large / small, 5.5);
}

TEST(CalibrateLens, TheCovarianceIsThatOfTheErrors) {
  constexpr int kTrials = 60;
  double sum = 0, dependence = 0;
  for (uint64_t seed = 0; seed < kTrials; ++seed) {
    const LensCalibration c = calibrate_lens(random_views(color_camera(), 25, 0.15, 100 + seed));
    sum += test::squared_deviations(c, color_camera()) / kTrials;
    dependence += c.sigma_inflation / kTrials;
  }
  // The mean of 60 chi-squares with 9 degrees of freedom has a deviation of 0.55; `dependence` only widens
  // it.
  EXPECT_LT(sum, test::kBrownConradyParameters + 2);
  EXPECT_GT(sum, test::kBrownConradyParameters * 0.5);
  EXPECT_LT(dependence, 1.35);
}

/// Boards that are not flat: each bent by some tenths of a millimetre in one direction, so that the errors of
/// all corners of a view are correlated.
std::vector<BoardView> views_of_bent_boards(uint64_t seed, double bend_m) {
  Random random(seed);
  std::vector<BoardView> views;
  const Board board = small_board();
  for (int i = 0; i < 25; ++i) {
    const SE3 pose = test::random_pose(random, board);
    const double bend = bend_m * random.gaussian(), twist = bend_m * random.gaussian();
    BoardView view = test::view_of(color_camera(), pose, board, fmt::format("view{}", i));
    for (size_t k = 0; k < view.pixels.size(); ++k) {
      const double u = view.board_m[k].x() / 0.06 - 1, v = view.board_m[k].y() / 0.09 - 1;
      const Eigen::Vector3d p(view.board_m[k].x(), view.board_m[k].y(),
                              bend * (u * u + v * v) + twist * u * v);
      view.pixels[k] = color_camera().distort(color_camera().project(pose * p));
    }
    test::add_noise(view, 0.05, random);
    views.push_back(view);
  }
  return views;
}

TEST(CalibrateLens, TheCovarianceCoversCorrelatedErrors) {
  constexpr int kTrials = 40;
  double sum = 0, as_if_independent = 0;
  for (uint64_t seed = 0; seed < kTrials; ++seed) {
    const LensCalibration c = calibrate_lens(views_of_bent_boards(seed, 4e-4));
    const double squared = test::squared_deviations(c, color_camera());
    sum += squared / kTrials;
    as_if_independent += squared * c.sigma_inflation * c.sigma_inflation / kTrials;
  }
  EXPECT_GT(as_if_independent, 2.5 * test::kBrownConradyParameters)
      << "the bend has no effect: nothing is tested";
  EXPECT_LT(sum, 1.6 * test::kBrownConradyParameters);
  EXPECT_GT(sum, 0.5 * test::kBrownConradyParameters);
}

TEST(CalibrateLens, AgreesWithOpenCvOnTheSameCorners) {
  const auto views = random_views(color_camera(), 12, 0.2, 5);
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const auto& view : views) {
    points.emplace_back(), pixels.emplace_back();
    for (size_t i = 0; i < view.pixels.size(); ++i) {
      points.back().emplace_back(view.board_m[i].x(), view.board_m[i].y(), 0);
      pixels.back().emplace_back(view.pixels[i].x(), view.pixels[i].y());
    }
  }
  cv::Mat K, D;
  std::vector<cv::Mat> rotations, translations;
  const cv::TermCriteria until(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 200, 1e-12);
  const double rms =
      cv::calibrateCamera(points, pixels, {1920, 1080}, K, D, rotations, translations, 0, until);
  const LensCalibration c = calibrate_lens(views);
  EXPECT_LE(c.rms_px, rms * (1 + 1e-6));
  EXPECT_NEAR(c.camera.fx, K.at<double>(0, 0), 0.02);
  EXPECT_NEAR(c.camera.fy, K.at<double>(1, 1), 0.02);
  EXPECT_NEAR(c.camera.cx, K.at<double>(0, 2), 0.02);
  EXPECT_NEAR(c.camera.cy, K.at<double>(1, 2), 0.02);
  EXPECT_NEAR(c.camera.lens.k1, D.at<double>(0), 1e-4);
  EXPECT_NEAR(c.camera.lens.p2, D.at<double>(3), 1e-5);
}

TEST(CalibrateLens, LeavesOutAndNamesViewsThatDoNotAgree) {
  auto views = random_views(color_camera(), 16, 0.1, 6);
  std::swap(views[3].pixels[0], views[3].pixels[20]);
  for (auto& pixel : views[11].pixels)
    pixel.x() += 1e-4 * pixel.y() * pixel.y();  // as with a rolling shutter
  const LensCalibration c = calibrate_lens(views);
  ASSERT_EQ(c.rejected.size(), 2U);
  EXPECT_EQ(c.rejected[0].name, "view3");
  EXPECT_EQ(c.rejected[1].name, "view11");
  EXPECT_THAT(c.rejected[0].reason, HasSubstr("RMS"));
  EXPECT_NEAR(c.camera.fx, color_camera().fx, 4 * c.std_deviations()(0));
}

TEST(CalibrateLens, EstimatesOnlyTheDistortionAskedFor) {
  CalibrationOptions options;
  options.distortion_terms = 2;
  const LensCalibration c = calibrate_lens(random_views(color_camera(), 12, 0.1, 7), options);
  EXPECT_EQ(c.camera.lens.p1, 0);
  EXPECT_EQ(c.camera.lens.k3, 0);
  EXPECT_NE(c.camera.lens.k1, 0);
  EXPECT_EQ(c.std_deviations()(6), 0);
  EXPECT_GT(c.std_deviations()(4), 0);
}

TEST(CalibrateLens, WarnsOfViewsThatAreTooAlike) {
  const LensCalibration alike = calibrate_lens(random_views(color_camera(), 20, 0.1, 8, 6));
  EXPECT_THAT(alike.warnings, Contains(HasSubstr("too alike")));
  EXPECT_THAT(alike.warnings, Contains(HasSubstr("do not constrain the focal length")));
  const LensCalibration good = calibrate_lens(random_views(color_camera(), 20, 0.1, 8));
  EXPECT_THAT(good.warnings, testing::Not(Contains(HasSubstr("too alike"))));
  EXPECT_LT(good.std_deviations()(0), alike.std_deviations()(0) / 3);
}

TEST(CalibrateLens, AcceptsThreeViewsWithAWarning) {
  const LensCalibration c = calibrate_lens(random_views(color_camera(), 3, 0.05, 9));
  EXPECT_THAT(c.warnings, Contains(HasSubstr("only 3 views")));
  EXPECT_NEAR(c.camera.fx, color_camera().fx, 0.05 * color_camera().fx);
}

TEST(CalibrateLens, RejectsDegenerateViews) {
  EXPECT_THAT(input_error([] { calibrate_lens(random_views(color_camera(), 2, 0, 1)); }),
              AllOf(HasSubstr("only 2"), HasSubstr("at least 3")));
  std::vector<BoardView> parallel;
  for (int i = 0; i < 5; ++i) {
    PinholeCamera camera = color_camera();
    camera.lens = {};
    const SE3 pose = test::board_at({0.02 * i, 0, 0.5 + 0.05 * i}, {0, 0, 0.1}, small_board());
    parallel.push_back(test::view_of(camera, pose, small_board(), fmt::format("v{}", i)));
  }
  EXPECT_THAT(input_error([&] { calibrate_lens(parallel); }), HasSubstr("tilt the board"));
}

TEST(CalibrateLens, MeasuresCoverage) {
  const auto views = random_views(color_camera(), 40, 0, 10);
  const LensCalibration many = calibrate_lens(views);
  const LensCalibration few = calibrate_lens({views.begin(), views.begin() + 4});
  EXPECT_GT(many.coverage.cells_share, few.coverage.cells_share);
  EXPECT_GT(few.coverage.cells_share, 0);
  EXPECT_LE(many.coverage.cells_share, 1);
  EXPECT_THAT(few.warnings, Contains(HasSubstr("corners cover only")));
}

}  // namespace
}  // namespace kinloop
