#include "viewer/scene/scene.hpp"

#include <gmock/gmock.h>

#include "tests/support/value_at.hpp"

namespace kinloop {
namespace {

using test::value_at;
using testing::ElementsAre;

/// The versions received by a browser that has seen `version` and takes everything.
std::vector<uint64_t> versions_after(const Scene& scene, uint64_t version) {
  std::vector<uint64_t> versions;
  while (const auto part = scene.next_after(version)) {
    version = part->version;
    versions.push_back(version);
  }
  return versions;
}

TEST(Scene, GivesEveryPartOnceInTheOrderOfChange) {
  Scene scene("run");
  scene.put(PartKind::kCloud, 0, {1});
  scene.put(PartKind::kCloud, 1, {2});
  scene.put(PartKind::kPath, 0, {3});
  EXPECT_THAT(versions_after(scene, 0), ElementsAre(1, 2, 3));
  EXPECT_THAT(versions_after(scene, 2), ElementsAre(3));
  EXPECT_THAT(versions_after(scene, 3), ElementsAre());
}

TEST(Scene, AChangedPartTakesTheEndOfTheQueueAndItsOldStateIsGone) {
  Scene scene("run");
  scene.put(PartKind::kCamera, 0, {1});
  scene.put(PartKind::kCloud, 0, {2});
  scene.put(PartKind::kCamera, 0, {3});
  EXPECT_THAT(versions_after(scene, 0), ElementsAre(2, 3));
  EXPECT_EQ(*scene.next_after(2)->body, WireBytes{3});
}

TEST(Scene, WhatStaysTheSameIsNotSentAgain) {
  Scene scene("run");
  scene.put(PartKind::kStatus, 0, {1, 2});
  scene.put(PartKind::kStatus, 0, {1, 2});
  EXPECT_THAT(versions_after(scene, 0), ElementsAre(1));
}

TEST(Scene, AnotherOneFollowsWithVersionsThatNoBrowserHasSeen) {
  Scene scene("run");
  scene.put(PartKind::kCloud, 0, {1});
  scene.put(PartKind::kPath, 0, {2});
  scene.restart("other");
  EXPECT_EQ(scene.run(), "other");
  EXPECT_EQ(scene.bytes(), 0U);
  EXPECT_THAT(versions_after(scene, 0), ElementsAre());
  scene.put(PartKind::kPath, 0, {2});
  EXPECT_THAT(versions_after(scene, 2), ElementsAre(3)) << "a browser that has the first scene receives it";
}

TEST(Scene, HoldsNoMoreThanItsParts) {
  Scene scene("run");
  for (uint8_t i = 0; i < 200; ++i) scene.put(PartKind::kColorImage, 0, WireBytes(1000, i));
  EXPECT_EQ(scene.bytes(), 1000U);
  EXPECT_EQ(versions_after(scene, 0).size(), 1U);
}

TEST(Scene, ASlowBrowserEndsUpWithTheLastStateOfEverything) {
  Scene scene("run");
  std::map<std::pair<PartKind, uint32_t>, WireBytes> slow, truth;
  uint64_t seen = 0;
  for (uint32_t step = 0; step < 1000; ++step) {
    const uint32_t index = step * 7 % 13;
    const WireBytes body = {static_cast<uint8_t>(step % 251)};
    scene.put(PartKind::kCloud, index, body);
    truth[{PartKind::kCloud, index}] = body;
    if (step % 5 != 0) continue;  // takes one part for every five that change
    const auto part = scene.next_after(seen);
    ASSERT_TRUE(part);
    slow[{part->kind, part->index}] = *part->body;
    seen = part->version;
  }
  while (const auto part = scene.next_after(seen)) {
    slow[{part->kind, part->index}] = *part->body;
    seen = part->version;
  }
  EXPECT_EQ(slow, truth);
}

TEST(Wire, HeaderHoldsThePartsIdentityAndSizeAndThePlaceOfThePiece) {
  const auto head = encode_header({PartKind::kCloud, 7, 123456789012345, 5'000'000'000, 131072});
  const WireBytes bytes(head.begin(), head.end());
  EXPECT_EQ(value_at<uint32_t>(bytes, 0), 7U);
  EXPECT_EQ(value_at<uint32_t>(bytes, 4), 7U);
  EXPECT_EQ(value_at<double>(bytes, 8), 123456789012345.0);
  EXPECT_EQ(value_at<double>(bytes, 16), 5e9);
  EXPECT_EQ(value_at<double>(bytes, 24), 131072.0);
}

TEST(Wire, APoseIsItsPlaceAndItsQuaternion) {
  const SE3 pose{exp_so3({0, 0, 1}), {1, 2, 3}};
  const WireBytes bytes = encode_poses({&pose, 1});
  ASSERT_EQ(bytes.size(), 28U);
  EXPECT_EQ(value_at<float>(bytes, 4), 2.0F);
  EXPECT_NEAR(value_at<float>(bytes, 20), std::sin(0.5), 1e-7);
  EXPECT_NEAR(value_at<float>(bytes, 24), std::cos(0.5), 1e-7);
}

/// Decodes a cloud as the page does.
std::vector<Eigen::Vector3f> decoded_points(const WireBytes& bytes) {
  std::vector<Eigen::Vector3f> points(value_at<uint32_t>(bytes, 4));
  const auto unit_m = value_at<float>(bytes, 8);
  const Eigen::Vector3f origin(value_at<float>(bytes, 12), value_at<float>(bytes, 16),
                               value_at<float>(bytes, 20));
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      points[i][static_cast<long>(k)] =
          static_cast<float>(value_at<int16_t>(bytes, 24 + 8 * i + 2 * k)) * unit_m;
    }
    points[i] += origin;
  }
  return points;
}

TEST(Wire, PointsKeepTheirPlaceToATenthOfAMillimetreAndTheirColour) {
  const CloudPiece piece{
      KeyframeId{5}, {{{1.00004F, -2, 3}, {0, 0.5F, 0.7F}, {-1, 0, 2}}, {{1, 2, 3}, {4, 5, 6}, {255, 0, 9}}}};
  const WireBytes bytes = encode_cloud(piece);
  ASSERT_EQ(bytes.size(), 24U + 3 * 12);
  EXPECT_EQ(value_at<uint32_t>(bytes, 0), 5U);
  const auto points = decoded_points(bytes);
  for (size_t i = 0; i < 3; ++i)
    EXPECT_LT((points[i] - piece.cloud.points[i]).cwiseAbs().maxCoeff(), 5.1e-5F);
  EXPECT_EQ(bytes[24 + 3 * 8 + 8], 255);
  EXPECT_EQ(bytes[24 + 3 * 8 + 10], 9);
}

TEST(Wire, ALargePieceOfTheWorldFitsToo) {
  const CloudPiece piece{{}, {{{-50, 0, 0}, {70, 1, 2}}, {{}, {}}}};
  const auto points = decoded_points(encode_cloud(piece));
  EXPECT_LT((points[0] - piece.cloud.points[0]).norm(), 2e-3F);
  EXPECT_LT((points[1] - piece.cloud.points[1]).norm(), 2e-3F);
  EXPECT_EQ(decoded_points(encode_cloud({})).size(), 0U);
}

TEST(Wire, FeaturesAreSharesOfTheImage) {
  const std::vector<ShownFeature> features = {{{0.5F, 1.2F}, true}, {{0, 0.25F}, false}};
  const WireBytes bytes = encode_features(features);
  ASSERT_EQ(bytes.size(), 16U);
  EXPECT_NEAR(value_at<uint16_t>(bytes, 0), 32768, 1);
  EXPECT_EQ(value_at<uint16_t>(bytes, 2), 65535);  // clamped to the image
  EXPECT_EQ(value_at<uint16_t>(bytes, 4), 1);
  EXPECT_EQ(value_at<uint16_t>(bytes, 12), 0);
}

}  // namespace
}  // namespace kinloop
