#include "tools/map_difference/map_difference.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "dense/surfels/voxel_samples.hpp"

namespace kinloop {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

/// A wall at z = 3 m and boxes before it, seen by cameras in a row that look along z.
class WallWithBoxes {
 public:
  struct Box {
    Eigen::Vector3d low, high;
    Rgb color;
  };

  explicit WallWithBoxes(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
    for (const double x : {-0.4, -0.2, 0.0, 0.2, 0.4}) look_from({x, 0, 0});
  }

  [[nodiscard]] Visit visit() const { return {cloud_, {images_, views_}}; }

  static ComparisonOptions options() {
    ComparisonOptions options;
    options.camera.color = kCamera;
    return options;
  }

 private:
  inline static const PinholeCamera kCamera{160, 120, 150, 150, 79.5, 59.5, {}};
  static constexpr double kWall_m = 3;

  /// Returns the depth of the front of what a ray meets, and its colour.
  [[nodiscard]] std::pair<double, Rgb> meet(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
    std::pair<double, Rgb> nearest{kWall_m, {200, 200, 200}};
    for (const Box& box : boxes_) {
      const double z = box.low.z();
      const Eigen::Vector3d p = from + z * ray;
      const bool inside =
          p.x() > box.low.x() && p.x() < box.high.x() && p.y() > box.low.y() && p.y() < box.high.y();
      if (inside && z < nearest.first) nearest = {z, box.color};
    }
    return nearest;
  }

  void look_from(const Eigen::Vector3d& from) {
    RgbdImages images{cv::Mat::zeros(kCamera.height, kCamera.width, CV_8UC3),
                      cv::Mat::zeros(kCamera.height, kCamera.width, CV_32FC1)};
    for (int row = 0; row < kCamera.height; ++row) {
      for (int col = 0; col < kCamera.width; ++col) {
        const Eigen::Vector3d ray((col - kCamera.cx) / kCamera.fx, (row - kCamera.cy) / kCamera.fy, 1);
        const auto [depth_m, color] = meet(from, ray);
        images.depth_m.at<float>(row, col) = static_cast<float>(depth_m);
        cloud_.points.push_back((from + depth_m * ray).cast<float>());
        cloud_.colors.push_back(color);
      }
    }
    views_.push_back({images_.add(images), {Eigen::Quaterniond::Identity(), from}});
  }

  std::vector<Box> boxes_;
  ImageStore images_;
  std::vector<PosedImage> views_;
  ColoredCloud cloud_;
};

const WallWithBoxes::Box kChest{{-0.9, -0.2, 2.4}, {-0.5, 0.4, 2.8}, {120, 60, 20}};
const WallWithBoxes::Box kBall{{0.2, -0.1, 2}, {0.5, 0.2, 2.2}, {30, 60, 200}};

WallWithBoxes::Box moved_by(WallWithBoxes::Box box, const Eigen::Vector3d& by) {
  box.low += by, box.high += by;
  return box;
}

std::vector<ObjectChange> changes(const MapDifference& difference) {
  std::vector<ObjectChange> found;
  for (const ChangedObject& object : difference.objects) found.push_back(object.change);
  return found;
}

MapDifference between(const WallWithBoxes& before, const WallWithBoxes& after) {
  return compare_visits_of_place(before.visit(), after.visit(), WallWithBoxes::options());
}

TEST(MapDifference, OfAPlaceThatStaysTheSameIsEmpty) {
  const WallWithBoxes room({kChest, kBall});
  const MapDifference difference = between(room, room);
  EXPECT_THAT(difference.objects, SizeIs(0));
  EXPECT_EQ(std::ranges::count(difference.before, PointChange::kChanged), 0);
}

TEST(MapDifference, TellsWhatIsGoneAndWhatWasAdded) {
  const WallWithBoxes with({kChest, kBall}), without({kChest});
  EXPECT_THAT(changes(between(with, without)), ElementsAre(ObjectChange::kGone));
  const MapDifference added = between(without, with);
  ASSERT_THAT(changes(added), ElementsAre(ObjectChange::kAdded));
  EXPECT_LT((added.objects[0].center_m - Eigen::Vector3d(0.35, 0.05, 2)).norm(), 0.03);
  EXPECT_NEAR(added.objects[0].surface_m2, 0.09, 0.04);
  EXPECT_THAT(added.objects[0].points_before, SizeIs(0));
  EXPECT_GT(added.objects[0].points_after.size(), 100U);
}

TEST(MapDifference, AnObjectElsewhereWasMoved) {
  const WallWithBoxes before({kChest, kBall}), after({kChest, moved_by(kBall, {-0.4, 0.1, 0.2})});
  const MapDifference difference = between(before, after);
  ASSERT_THAT(changes(difference), ElementsAre(ObjectChange::kMoved));
  const Eigen::Vector3d by = difference.objects[0].moved_to_m - difference.objects[0].center_m;
  EXPECT_LT((by - Eigen::Vector3d(-0.4, 0.1, 0.2)).norm(), 0.03);
  const auto mean_of = [](const ColoredCloud& cloud, const std::vector<uint32_t>& points) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const uint32_t i : points) sum += cloud.points[i];
    return Eigen::Vector3d((sum / static_cast<float>(points.size())).cast<double>());
  };
  const ChangedObject& ball = difference.objects[0];
  EXPECT_LT((mean_of(before.visit().cloud, ball.points_before) - ball.center_m).norm(), 1e-3);
  EXPECT_LT((mean_of(after.visit().cloud, ball.points_after) - ball.moved_to_m).norm(), 1e-3);
}

TEST(MapDifference, AnotherObjectInItsPlaceElsewhereIsNotTheOneThatIsGone) {
  WallWithBoxes::Box red = moved_by(kBall, {-0.5, 0, 0});
  red.color = {220, 30, 30};
  EXPECT_THAT(changes(between(WallWithBoxes({kBall}), WallWithBoxes({red}))),
              ElementsAre(ObjectChange::kGone, ObjectChange::kAdded));
}

TEST(MapDifference, NothingIsSaidOfWhatWasHidden) {
  const WallWithBoxes::Box screen{{0, -0.5, 1.2}, {0.8, 0.5, 1.3}, {0, 0, 0}};
  const MapDifference difference = between(WallWithBoxes({kBall}), WallWithBoxes({screen}));
  EXPECT_THAT(changes(difference), ElementsAre(ObjectChange::kAdded))
      << "the screen; the ball may be behind it";
}

TEST(MapDifference, IsWrittenAsNumbersAndColours) {
  const WallWithBoxes with({kBall}), without({});
  const MapDifference difference = between(with, without);
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  const nlohmann::json numbers = to_json(difference, turned);
  EXPECT_EQ(numbers["objects"][0]["change"], "gone");
  EXPECT_NEAR(numbers["objects"][0]["center_m"][2].get<double>(), 0.05, 0.03) << "y became z";
  const auto gone = numbers["before"]["gone"].get<int>();
  EXPECT_GT(gone, 100);
  const ColoredCloud cloud = color_difference(with.visit().cloud, without.visit().cloud, difference);
  ASSERT_EQ(cloud.size(), with.visit().cloud.size() + without.visit().cloud.size());
  const auto is_red = [](const Rgb& color) { return color[0] > 2 * color[1]; };
  EXPECT_EQ(std::ranges::count_if(cloud.colors, is_red), gone);
}

}  // namespace
}  // namespace kinloop
