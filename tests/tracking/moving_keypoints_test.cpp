#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/sensor/surfaces/surface_mask.hpp"
#include "kinloop/tracking/evidence/moved_points.hpp"
#include "tests/sensor/vga_surfaces.hpp"

namespace kinloop {
namespace {

/// A textured wall 2 m away, seen twice. Keypoints of the second image are 20 px apart; the lowest rows
/// observe landmarks. A box of the image may have been elsewhere in the first image.
class MovingKeypoints : public testing::Test {
 protected:
  static constexpr double kDepth_m = 2;
  static constexpr int kLandmarkRow_px = 400;

  MovingKeypoints() {
    Random random(3);
    wall_.create(480, 640, CV_8UC1);
    for (int y = 0; y < 480; y += 8) {
      for (int x = 0; x < 640; x += 8) wall_(cv::Rect(x, y, 8, 8)) = cv::Scalar(random.uniform(40, 220));
    }
  }

  [[nodiscard]] TrackedFrame seen_by(const cv::Mat& image) const {
    Frame frame;
    frame.gray = image;
    frame.surfaces = std::make_shared<const SurfaceGrid>(
        make_surface_grid(camera_, cv::Mat(480, 640, CV_32FC1, cv::Scalar(kDepth_m))));
    Features features;
    for (int y = 20; y < 480; y += 20) {
      for (int x = 20; x < 640; x += 20) {
        const Eigen::Vector2f pixel(static_cast<float>(x), static_cast<float>(y));
        features.raw_pixels.push_back(pixel);
        features.pixels.push_back(pixel);
        features.measured_pixels.push_back(pixel);
        features.depths_m.push_back(static_cast<float>(kDepth_m));
      }
    }
    TrackedFrame tracked;
    for (uint32_t i = 0; i < features.size(); ++i) {
      if (features.pixels[i].y() >= kLandmarkRow_px) tracked.matches.push_back({LandmarkId{i}, i});
    }
    frame.features = std::make_shared<const Features>(std::move(features));
    tracked.frame = std::make_shared<const Frame>(std::move(frame));
    return tracked;
  }

  /// The image in which `box` shows what lies `shift_px` further to the right.
  [[nodiscard]] cv::Mat with_moved(const cv::Rect& box, int shift_px) const {
    cv::Mat image = wall_.clone();
    wall_(box + cv::Point(shift_px, 0)).copyTo(image(box));
    return image;
  }

  static double share_of(const cv::Mat& points, const cv::Rect& box) {
    const cv::Rect cells(box.x / 10, box.y / 10, box.width / 10, box.height / 10);
    return points.empty() ? 0 : static_cast<double>(cv::countNonZero(points(cells))) / cells.area();
  }

  std::shared_ptr<const SurfaceCamera> camera_ = test::vga_surface_camera();
  Sensor sensor_ = test::sensor_of(test::vga_camera());
  cv::Mat wall_;
};

const cv::Rect kMovingBox(200, 100, 200, 200);

TEST_F(MovingKeypoints, NothingMovesBeforeACameraAtRest) {
  const TrackedFrame frame = seen_by(wall_);
  EXPECT_TRUE(moving_points(frame, frame, SE3{}, sensor_).empty());
}

TEST_F(MovingKeypoints, ABoxThatWasElsewhereMoves) {
  const cv::Mat points = moving_points(seen_by(with_moved(kMovingBox, 8)), seen_by(wall_), SE3{}, sensor_);
  EXPECT_GT(share_of(points, kMovingBox), 0.85);
  EXPECT_LT(marked_share(points), 1.3 * kMovingBox.area() / (640.0 * 480.0));
}

TEST_F(MovingKeypoints, ABoxDisplacedByLessThanKeypointsAreImpreciseIsAtRest) {
  EXPECT_TRUE(moving_points(seen_by(with_moved(kMovingBox, 1)), seen_by(wall_), SE3{}, sensor_).empty());
}

TEST_F(MovingKeypoints, TheMotionOfTheCameraIsTakenIntoAccount) {
  // The camera moves by 8 px to the left: the wall moves to the right in the image.
  cv::Mat shifted;
  const cv::Mat by_8_px = (cv::Mat_<double>(2, 3) << 1, 0, 8, 0, 1, 0);
  cv::warpAffine(wall_, shifted, by_8_px, wall_.size());
  SE3 T_earlier_tracked;
  T_earlier_tracked.translation.x() = -8 * kDepth_m / sensor_.camera.fx;
  EXPECT_TRUE(moving_points(seen_by(shifted), seen_by(wall_), T_earlier_tracked, sensor_).empty());
  // The same image from a camera that is thought to be at rest: the landmarks move too, so nothing is known.
  EXPECT_TRUE(moving_points(seen_by(shifted), seen_by(wall_), SE3{}, sensor_).empty());
}

TEST_F(MovingKeypoints, WithoutLandmarksNothingTellsHowPreciseItIs) {
  TrackedFrame frame = seen_by(with_moved(kMovingBox, 8));
  frame.matches.resize(10);
  EXPECT_TRUE(moving_points(frame, seen_by(wall_), SE3{}, sensor_).empty());
}

TEST_F(MovingKeypoints, KeypointsWithoutDepthAreLeftOut) {
  TrackedFrame frame = seen_by(with_moved(kMovingBox, 8));
  Features features = frame.features();
  for (size_t i = 0; i < features.size(); ++i) {
    if (features.pixels[i].y() < kLandmarkRow_px) features.depths_m[i] = 0;
  }
  Frame images = *frame.frame;
  images.features = std::make_shared<const Features>(std::move(features));
  frame.frame = std::make_shared<const Frame>(std::move(images));
  EXPECT_TRUE(moving_points(frame, seen_by(wall_), SE3{}, sensor_).empty());
}

}  // namespace
}  // namespace kinloop
