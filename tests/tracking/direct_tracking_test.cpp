// Alignment of patches and images on synthetic textures with known shifts and motions.

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/features/patches.hpp"
#include "kinloop/tracking/direct/alignment.hpp"
#include "kinloop/tracking/direct/patch_search.hpp"

namespace kinloop {
namespace {

/// A smooth texture without period, intensity levels.
double texture(double x, double y) {
  return 120 + 45 * std::sin(0.53 * x + 0.5) * std::cos(0.47 * y) + 25 * std::sin(0.21 * x - 0.57 * y + 1) +
         15 * std::cos(0.05 * x + 0.17 * y);
}

/// The texture under `source`, which maps a pixel to texture coordinates.
template <class Source>
cv::Mat render(int width, int height, const Source& source) {
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Eigen::Vector2d at = source(Eigen::Vector2d(x, y));
      image.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(texture(at.x(), at.y()));
    }
  }
  return image;
}

Patch patch_at(const cv::Mat& image, const Eigen::Vector2f& pixel) {
  Features features;
  features.raw_pixels = {pixel};
  features.pixels = {pixel};
  features.levels = {0};
  return *cut_patches({image}, features, {true}).find(0);
}

constexpr int kWidth_px = 100, kHeight_px = 80;
const Eigen::Vector2f kPoint(50.3F, 40.6F);

class AlignPatch : public testing::Test {
 protected:
  const cv::Mat image_ = render(kWidth_px, kHeight_px, [](const Eigen::Vector2d& pixel) { return pixel; });
  const Patch patch_ = patch_at(image_, kPoint);
};

TEST_F(AlignPatch, FindsTheShiftToAFractionOfAPixel) {
  const auto made = make_template(patch_, Eigen::Matrix2f::Identity());
  ASSERT_TRUE(made);
  for (const Eigen::Vector2d& shift : {Eigen::Vector2d(0, 0), {0.4, -0.7}, {-1.6, 1.2}, {2.2, 0.9}}) {
    const cv::Mat moved =
        render(kWidth_px, kHeight_px, [&](const Eigen::Vector2d& pixel) { return pixel - shift; });
    const auto found = align_patch(*made, moved, kPoint, 4);
    ASSERT_TRUE(found) << shift.transpose();
    EXPECT_LT((found->position - kPoint - shift.cast<float>()).norm(), 0.02) << shift.transpose();
    EXPECT_GT(found->correlation, 0.99);
  }
}

TEST_F(AlignPatch, IsIndependentOfGainAndOffset) {
  const auto made = make_template(patch_, Eigen::Matrix2f::Identity());
  ASSERT_TRUE(made);
  cv::Mat darker;
  image_.convertTo(darker, -1, 0.5, 20);
  const auto found = align_patch(*made, darker, kPoint + Eigen::Vector2f(1, -1), 4);
  ASSERT_TRUE(found);
  EXPECT_LT((found->position - kPoint).norm(), 0.01);
}

TEST_F(AlignPatch, FollowsAnAffineWarp) {
  Eigen::Matrix2d warp;  // texture coordinates per pixel
  warp << 0.9, -0.3, 0.2, 0.95;
  const Eigen::Vector2d point = kPoint.cast<double>();
  const cv::Mat warped = render(kWidth_px, kHeight_px, [&](const Eigen::Vector2d& pixel) {
    return Eigen::Vector2d(point + warp * (pixel - point));
  });
  const auto made = make_template(patch_, warp.cast<float>());
  ASSERT_TRUE(made);
  const auto found = align_patch(*made, warped, kPoint + Eigen::Vector2f(-1, 0.5F), 4);
  ASSERT_TRUE(found);
  EXPECT_LT((found->position - kPoint).norm(), 0.015);
}

TEST_F(AlignPatch, RejectsWhatItCannotLocate) {
  const cv::Mat flat(kHeight_px, kWidth_px, CV_8UC1, cv::Scalar(90));
  EXPECT_FALSE(make_template(patch_at(flat, kPoint), Eigen::Matrix2f::Identity()));
  const cv::Mat edge = render(kWidth_px, kHeight_px, [](const Eigen::Vector2d& pixel) {
    return Eigen::Vector2d(pixel.x() < 50 ? 0 : 12, 0);
  });
  EXPECT_FALSE(make_template(patch_at(edge, kPoint), Eigen::Matrix2f::Identity()));
  EXPECT_FALSE(make_template(patch_, 3 * Eigen::Matrix2f::Identity()));  // larger than the patch
  const auto made = make_template(patch_, Eigen::Matrix2f::Identity());
  ASSERT_TRUE(made);
  EXPECT_FALSE(align_patch(*made, flat, kPoint, 4));
  EXPECT_FALSE(align_patch(*made, image_, {2, 2}, 4));  // beyond the border
}

TEST(CutPatches, LeavesOutKeypointsAtTheBorderAndUnwantedOnes) {
  const cv::Mat image(kHeight_px, kWidth_px, CV_8UC1, cv::Scalar(90));
  Features features;
  features.raw_pixels = {{50, 40}, {3, 40}, {60, 40}};
  features.pixels = features.raw_pixels;
  features.levels = {0, 0, 0};
  const auto patches = cut_patches({image}, features, {true, true, false});
  ASSERT_NE(patches.find(0), nullptr);
  EXPECT_EQ(patches.find(0)->octave, 0);
  EXPECT_EQ(patches.find(1), nullptr);
  EXPECT_EQ(patches.find(2), nullptr);
}

PinholeCamera vga_camera() {
  PinholeCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 500;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

/// A textured wall in front of a camera that moves by up to 8 px.
class Wall : public testing::Test {
 protected:
  static constexpr double kDistance_m = 2;

  [[nodiscard]] cv::Mat view(const SE3& T_world_camera, double texture_per_m) const {
    return render(camera.width, camera.height, [&](const Eigen::Vector2d& pixel) {
      const Eigen::Vector3d ray = T_world_camera.rotation * camera.unproject(pixel, 1);
      const double length = (kDistance_m - T_world_camera.translation.z()) / ray.z();
      const Eigen::Vector3d p = T_world_camera.translation + length * ray;
      return Eigen::Vector2d(texture_per_m * p.head<2>());
    });
  }

  const PinholeCamera camera = vga_camera();
  const SE3 truth = SE3::exp((Vector6d() << 0.02, -0.01, 0.015, 0.006, -0.01, 0.008).finished());
};

TEST_F(Wall, AlignmentOfImagesFindsTheMotion) {
  std::vector<AlignmentPoint> points;
  for (int y = 60; y < camera.height; y += 40) {
    for (int x = 60; x < camera.width; x += 40) {
      const Eigen::Vector2d pixel(x, y);
      points.push_back({camera.unproject(pixel, kDistance_m), pixel, pixel});
    }
  }
  constexpr double kCoarse_per_m = 100;  // the motion is within half a period
  const SE3 found = align_images(make_octaves(view({}, kCoarse_per_m), 4),
                                 make_octaves(view(truth, kCoarse_per_m), 4), points, camera);
  EXPECT_LT((found.translation - truth.translation).norm(), 0.001);
  EXPECT_LT((found.inverse() * truth).angle_rad(), 0.0006);
}

/// Keypoints at the given pixels of the wall.
Features keypoints_at(const std::vector<Eigen::Vector2f>& pixels) {
  Features features;
  features.raw_pixels = features.pixels = features.measured_pixels = pixels;
  features.levels.assign(pixels.size(), 0);
  features.sigmas_px.assign(pixels.size(), 1);
  return features;
}

TEST_F(Wall, RefinementMovesKeypointsToTheirLandmarks) {
  constexpr double kFine_per_m = 200;  // every patch has texture
  LocalMap map;
  std::vector<Eigen::Vector2f> seen, detected;
  std::vector<LandmarkMatch> matches;
  const Eigen::Vector2f error(0.9F, -0.7F);
  for (int y = 100; y < 400; y += 60) {
    for (int x = 100; x < 600; x += 60) {
      const auto index = static_cast<uint32_t>(seen.size());
      seen.emplace_back(x, y);
      map.ids.push_back(LandmarkId{index});
      map.index_of.emplace(LandmarkId{index}, index);
      map.p_reference.push_back(camera.unproject(seen.back().cast<double>(), kDistance_m));
      map.view_of.push_back(0);
      map.feature_of.push_back(index);
      detected.push_back(camera.project(truth.inverse() * map.p_reference.back()).cast<float>() + error);
      matches.push_back({LandmarkId{index}, index});
    }
  }
  const auto at_keyframe = std::make_shared<const Features>(keypoints_at(seen));
  const std::vector<bool> all(seen.size(), true);
  const ImageOctaves octaves = make_octaves(view({}, kFine_per_m), 4);
  map.views.push_back({KeyframeId{0}, SE3{}, at_keyframe,
                       std::make_shared<const KeypointPatches>(cut_patches(octaves, *at_keyframe, all)),
                       nullptr});
  matches.erase(matches.begin());               // the first keypoint matches nothing
  matches.front().landmark = LandmarkId{1000};  // the second a landmark beyond the local map
  Frame frame;
  frame.octaves = make_octaves(view(truth, kFine_per_m), 4);
  frame.features = std::make_shared<const Features>(keypoints_at(detected));
  const Sensor sensor{camera};
  const Features refined = refine_keypoints(frame, matches, truth, {map, sensor, {}});
  int moved = 0;
  for (size_t i = 0; i < detected.size(); ++i) {
    if (i < 2 || refined.sigmas_px[i] == 1) {
      EXPECT_EQ(refined.raw_pixels[i], detected[i]);
      EXPECT_EQ(refined.sigmas_px[i], 1);
      continue;
    }
    EXPECT_LT((refined.raw_pixels[i] - (detected[i] - error)).norm(), 0.07);
    EXPECT_LT((refined.measured_pixels[i] - refined.raw_pixels[i]).norm(), 1e-6);
    EXPECT_LT(refined.sigmas_px[i], 1);
    ++moved;
  }
  EXPECT_GT(moved, static_cast<int>(detected.size()) * 3 / 4);
}

}  // namespace
}  // namespace kinloop
