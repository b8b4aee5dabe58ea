#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/features/extraction/surf.hpp"
#include "tests/features/cluttered_image.hpp"
#include "tools/feature_comparison/detectors.hpp"
#include "tools/feature_comparison/draw_matches.hpp"
#include "tools/feature_comparison/evaluate_pair.hpp"

namespace kinloop {
namespace {

using test::ideal_camera;

/// A cluttered wall 2 m away, seen again from 0.2 m to the right: everything moves by 52.5 px.
struct TwoViews {
  cv::Mat gray_a, gray_b, depth_m;
  SE3 T_b_a;

  TwoViews() : depth_m(480, 640, CV_32FC1, cv::Scalar(2.0F)) {
    gray_a = test::cluttered_image(41);
    const cv::Matx33d shift(1, 0, -52.5, 0, 1, 0, 0, 0, 1);
    cv::warpPerspective(gray_a, gray_b, shift, gray_a.size());
    T_b_a.translation.x() = -0.2;
  }
};

TEST(Detectors, EachFindsWhatItIsAskedFor) {
  const cv::Mat gray = test::cluttered_image(40);
  FeatureOptions options;
  options.count = 300;
  std::vector<std::string> ids;
  for (const Detector& detector : make_detectors(options, ideal_camera())) {
    const Features f = detector.detect(gray);
    ids.push_back(detector.id);
    EXPECT_GT(f.size(), 200U) << detector.name;
    EXPECT_LT(f.size(), 330U) << detector.name;
    EXPECT_EQ(f.descriptors.rows, static_cast<int>(f.size())) << detector.name;
    EXPECT_EQ(f.raw_pixels.size(), f.size()) << detector.name;
  }
  EXPECT_THAT(ids, testing::IsSupersetOf({"sift", "orb-opencv", "orb"}));
  EXPECT_EQ(std::find(ids.begin(), ids.end(), "surf") != ids.end(), surf_available());
}

TEST(EvaluatePair, EveryDetectorRepeatsOnAWall) {
  const TwoViews views;
  const auto detectors = make_detectors({}, ideal_camera());
  ASSERT_GE(detectors.size(), 3U);
  for (const Detector& detector : detectors) {
    const Features a = detector.detect(views.gray_a), b = detector.detect(views.gray_b);
    const auto matches = match_descriptors(a, b);
    const auto screened = filter_by_distance(matches, a.descriptors.type() == CV_8UC1);
    const auto true_pixels =
        ground_truth_pixels_from_motion(a, views.depth_m, views.depth_m, ideal_camera(), views.T_b_a);
    const PairMetrics metrics = evaluate_pair(b, matches, screened, true_pixels);
    EXPECT_EQ(metrics.matches, matches.size());
    EXPECT_GT(metrics.visible, 500U) << detector.name;
    EXPECT_GT(metrics.repeated, metrics.visible / 2) << detector.name;
    EXPECT_GT(metrics.correct, metrics.checked * 8 / 10) << detector.name;
    const auto inliers = motion_inliers({a, b, screened}, views.depth_m, ideal_camera(), 1);
    EXPECT_GT(inliers.size(), screened.size() * 7 / 10) << detector.name;
    EXPECT_LE(inliers.size(), screened.size()) << detector.name;
  }
}

/// Four keypoints at known positions; only these matter.
Features at(const std::vector<Eigen::Vector2f>& pixels) {
  Features features;
  features.pixels = features.raw_pixels = pixels;
  return features;
}

TEST(EvaluatePair, CountsWhatTheTruthSays) {
  const Features b = at({{100, 100}, {200, 202}, {300, 310}});
  const GroundTruthPixels true_pixels{Eigen::Vector2d(100, 100), Eigen::Vector2d(200, 200),
                                      Eigen::Vector2d(300, 300), std::nullopt};
  // Correct, 2 px off, 10 px off, and one without ground truth.
  const std::vector<DescriptorMatch> matches{{0, 0, 5}, {1, 1, 6}, {2, 2, 7}, {3, 0, 8}};
  const PairMetrics metrics = evaluate_pair(b, matches, matches, true_pixels);
  EXPECT_EQ(metrics.visible, 3U);
  EXPECT_EQ(metrics.repeated, 2U);
  EXPECT_EQ(metrics.checked, 3U);
  EXPECT_EQ(metrics.correct, 2U);
  EXPECT_THAT(metrics.errors_px, testing::ElementsAre(0, 2));
}

TEST(GroundTruthPixels, HiddenAndUnknownPointsHaveNone) {
  const Features a = at({{320, 240}, {100, 240}, {5, 240}});
  cv::Mat depth_a(480, 640, CV_32FC1, cv::Scalar(2.0F)), depth_b = depth_a.clone();
  SE3 T_b_a;
  T_b_a.translation.x() = -0.2;
  EXPECT_NEAR((*ground_truth_pixels_from_motion(a, depth_a, depth_b, ideal_camera(), T_b_a)[0]).x(), 267.5,
              1e-9);
  EXPECT_FALSE(
      ground_truth_pixels_from_motion(a, depth_a, depth_b, ideal_camera(), T_b_a)[2]);  // out of view
  depth_b.setTo(1.0F);
  EXPECT_FALSE(ground_truth_pixels_from_motion(a, depth_a, depth_b, ideal_camera(), T_b_a)[0]);  // occluded
  depth_a.setTo(0.0F);
  EXPECT_FALSE(
      ground_truth_pixels_from_motion(a, depth_a, depth_b, ideal_camera(), T_b_a)[0]);  // unknown depth
}

TEST(Screen, IsFourTimesTheSmallest) {
  const std::vector<DescriptorMatch> matches{{0, 0, 5}, {1, 1, 20}, {2, 2, 21}, {3, 3, 41}};
  EXPECT_EQ(filter_by_distance(matches, false).size(), 2U);
  EXPECT_EQ(filter_by_distance(matches, true).size(), 3U);  // never less than 40 bits
  EXPECT_TRUE(filter_by_distance({}, true).empty());
}

/// Whether a match is correct, for the wall that moves by 52.5 px.
bool is_correct(const DescriptorMatch& match, const Features& a, const Features& b) {
  const Eigen::Vector2f moved = b.pixels[match.b] - a.pixels[match.a];
  return (moved - Eigen::Vector2f(-52.5F, 0)).norm() < 4;
}

TEST(Inliers, AreTheRightMatchesWhateverTheSeed) {
  const TwoViews views;
  const auto orb = make_detectors({}, ideal_camera()).back();
  const Features a = orb.detect(views.gray_a), b = orb.detect(views.gray_b);
  const auto matches = filter_by_distance(match_descriptors(a, b), true);
  const auto right = static_cast<size_t>(std::count_if(
      matches.begin(), matches.end(), [&](const DescriptorMatch& match) { return is_correct(match, a, b); }));
  ASSERT_GT(right, 100U);
  for (uint64_t seed = 0; seed < 5; ++seed) {
    for (const auto& inliers :
         {homography_inliers({a, b, matches}, seed), epipolar_inliers({a, b, matches}, seed),
          motion_inliers({a, b, matches}, views.depth_m, ideal_camera(), seed)}) {
      EXPECT_GT(inliers.size(), right * 9 / 10);
      EXPECT_LT(std::count_if(inliers.begin(), inliers.end(),
                              [&](const DescriptorMatch& match) { return !is_correct(match, a, b); }),
                static_cast<long>(inliers.size() / 10));
    }
  }
}

bool same(const std::vector<DescriptorMatch>& a, const std::vector<DescriptorMatch>& b) {
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(),
      [](const DescriptorMatch& x, const DescriptorMatch& y) { return x.a == y.a && x.b == y.b; });
}

TEST(Inliers, AreTheSameForTheSameSeed) {
  const TwoViews views;
  const auto orb = make_detectors({}, ideal_camera()).back();
  const Features a = orb.detect(views.gray_a), b = orb.detect(views.gray_b);
  const auto matches = match_descriptors(a, b);
  EXPECT_TRUE(same(homography_inliers({a, b, matches}, 7), homography_inliers({a, b, matches}, 7)));
  EXPECT_TRUE(same(epipolar_inliers({a, b, matches}, 7), epipolar_inliers({a, b, matches}, 7)));
  EXPECT_FALSE(same(epipolar_inliers({a, b, matches}, 7), epipolar_inliers({a, b, matches}, 8)))
      << "another seed orders the matches differently";
}

TEST(Inliers, OfTooFewMatchesThereAreNone) {
  const TwoViews views;
  const auto orb = make_detectors({}, ideal_camera()).back();
  const Features a = orb.detect(views.gray_a), b = orb.detect(views.gray_b);
  const std::vector<DescriptorMatch> three = {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}};
  EXPECT_TRUE(homography_inliers({a, b, three}, 1).empty());
  EXPECT_TRUE(epipolar_inliers({a, b, three}, 1).empty());
  EXPECT_TRUE(motion_inliers({a, b, three}, views.depth_m, ideal_camera(), 1).empty());
}

TEST(DrawMatches, ShowsBothImagesAndALine) {
  const cv::Mat gray(40, 60, CV_8UC1, cv::Scalar(128));
  const Features a = at({{10, 20}}), b = at({{50, 20}});
  const cv::Mat picture = draw_matches(gray, a, gray, b, {{0, 0, 1}});
  EXPECT_EQ(picture.size(), cv::Size(120, 40));
  EXPECT_NE(picture.at<cv::Vec3b>(20, 60), cv::Vec3b(128, 128, 128));
  EXPECT_EQ(picture.at<cv::Vec3b>(5, 60), cv::Vec3b(128, 128, 128));
  EXPECT_THROW(draw_matches(gray, a, cv::Mat(10, 10, CV_8UC3), b, {}), std::logic_error);
}

TEST(DrawMatches, TakesImagesOfDifferentSizes) {
  const cv::Mat wide(40, 60, CV_8UC1, cv::Scalar(128)), high(70, 20, CV_8UC1, cv::Scalar(200));
  const cv::Mat picture = draw_matches(wide, at({{10, 20}}), high, at({{10, 60}}), {});
  EXPECT_EQ(picture.size(), cv::Size(80, 70));
  EXPECT_EQ(picture.at<cv::Vec3b>(69, 79), cv::Vec3b(200, 200, 200));
  EXPECT_EQ(picture.at<cv::Vec3b>(69, 30), cv::Vec3b(0, 0, 0));
}

TEST(DrawMatches, HasItsCaptionBelow) {
  const cv::Mat picture(40, 300, CV_8UC3, cv::Scalar(1, 2, 3));
  const cv::Mat captioned = add_caption(picture, {"12 matches", "7 inliers"});
  EXPECT_EQ(captioned.cols, 300);
  ASSERT_GT(captioned.rows, 60);
  EXPECT_EQ(cv::norm(captioned.rowRange(0, 40), picture, cv::NORM_INF), 0);
  cv::Mat ink;
  cv::inRange(captioned.rowRange(40, captioned.rows), cv::Scalar::all(0), cv::Scalar::all(100), ink);
  EXPECT_GT(cv::countNonZero(ink), 50);
}

TEST(MatchDescriptors, RefusesDifferentKindsAndTakesEmptyOnes) {
  Features bits = at({{1, 1}}), floats = at({{1, 1}});
  bits.descriptors = cv::Mat::zeros(1, 32, CV_8UC1);
  floats.descriptors = cv::Mat::zeros(1, 64, CV_32FC1);
  EXPECT_THROW(match_descriptors(bits, floats), std::logic_error);
  EXPECT_TRUE(match_descriptors(bits, Features()).empty());
}

}  // namespace
}  // namespace kinloop
