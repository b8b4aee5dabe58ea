// The mesh that grows during a run.

#include "dense/live_mesh/live_mesh.hpp"

#include <limits>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "dense/live_mesh/fusion_view.hpp"
#include "dense/undistorted_images.hpp"
#include "tests/dense/plane_view.hpp"

namespace kinloop {
namespace {

using test::distorted_camera;
using test::small_camera;
using test::view_of_wall;

constexpr double kFrontWallZ_m = 1.5;
const cv::Vec3b kGreen(0, 200, 0);

SE3 at(double x, double y = 0, double z = 0) {
  return {Eigen::Quaterniond::Identity(), {x, y, z}};
}

/// A mesh, and what a browser that received its pieces would have of them.
class Receiver {
 public:
  explicit Receiver(const LiveMeshOptions& options = {.voxel_m = 0.02},
                    const DenseCamera& camera = {.color = small_camera()})
      : mesh_(options), camera_(camera), limits_(options.limits) {}

  /// Fuses a new keyframe and takes the pieces that changed much.
  void add(const RgbdImages& images, const SE3& T_world_camera, const Velocity& velocity = {}) {
    poses_.push_back(T_world_camera);
    mesh_.correct(poses_);
    FusionView view = make_fusion_view(images, camera_, undistortion_of(camera_.color), limits_);
    view.velocity = velocity;
    mesh_.fuse(view, KeyframeId{static_cast<uint32_t>(poses_.size()) - 1}, SE3());
    take(false);
  }

  void add_wall(const SE3& T_world_camera, double wall_z_m = kFrontWallZ_m) {
    add(view_of_wall(camera_.color, T_world_camera, wall_z_m, kGreen), T_world_camera);
  }

  /// Returns the number of pieces that changed.
  size_t take(bool all) {
    const auto changed = mesh_.take_changed(std::numeric_limits<size_t>::max(), all);
    for (const MeshPiece& piece : changed) pieces_.insert_or_assign(piece.index, piece);
    return changed.size();
  }

  /// All vertices in the world.
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const {
    std::vector<Eigen::Vector3d> points;
    for (const auto& [index, piece] : pieces_) {
      for (const auto& p : piece.surface.mesh.points)
        points.push_back(poses_[piece.anchor.value] * p.cast<double>());
    }
    return points;
  }

  [[nodiscard]] double area_m2() const {
    double area_m2 = 0;
    for (const auto& [index, piece] : pieces_) {
      const auto& mesh = piece.surface.mesh;
      for (const auto& [a, b, c] : mesh.triangles) {
        const Eigen::Vector3f twice =
            (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]);
        area_m2 += static_cast<double>(twice.norm()) / 2;
      }
    }
    return area_m2;
  }

  LiveMesh& mesh() { return mesh_; }
  std::vector<SE3>& poses() { return poses_; }
  [[nodiscard]] const std::map<uint32_t, MeshPiece>& pieces() const { return pieces_; }

 private:
  LiveMesh mesh_;
  DenseCamera camera_;
  DepthLimits limits_;
  std::vector<SE3> poses_;
  std::map<uint32_t, MeshPiece> pieces_;
};

/// What a camera at `T_world_camera` sees of the wall and of another one at x = `side_x_m`.
RgbdImages view_of_corner(const SE3& T_world_camera, double side_x_m) {
  const PinholeCamera camera = small_camera();
  RgbdImages images = view_of_wall(camera, T_world_camera, kFrontWallZ_m, kGreen);
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      const Eigen::Vector3d ray = T_world_camera.R() * camera.unproject(Eigen::Vector2d(col, row), 1);
      const double depth_m = (side_x_m - T_world_camera.translation.x()) / ray.x();
      auto& z = images.depth_m.at<float>(row, col);
      if (depth_m > 0 && depth_m < static_cast<double>(z)) z = static_cast<float>(depth_m);
    }
  }
  return images;
}

/// Keyframe poses along a wall. The camera sways, so that the voxels of submaps are not aligned.
std::vector<SE3> walk(double length_m) {
  constexpr double kStep_m = 0.25;
  std::vector<SE3> poses;
  for (double x = 0; x < length_m; x += kStep_m)
    poses.push_back({exp_so3({0, 0.1 * std::sin(5 * x), 0.1 * std::sin(2 * x)}), {x, 0, 0}});
  return poses;
}

Receiver after_walk(double length_m) {
  Receiver seen;
  for (const SE3& pose : walk(length_m)) seen.add_wall(pose);
  seen.take(true);
  return seen;
}

/// Area of the wall that the keyframes see, in pixels that may define a surface.
double seen_m2(const std::vector<SE3>& poses) {
  constexpr double kCell_m = 0.01;
  std::set<std::pair<int, int>> cells;
  const PinholeCamera camera = small_camera();
  for (const SE3& T_world_camera : poses) {
    for (double x = -3; x < 3; x += kCell_m) {
      for (double y = -2; y < 2; y += kCell_m) {
        const Eigen::Vector3d p(x + std::round(T_world_camera.translation.x()), y, kFrontWallZ_m);
        const Eigen::Vector3d p_camera = T_world_camera.inverse() * p;
        if (p_camera.z() > 0 && camera.contains(camera.project(p_camera), 2))
          cells.emplace(std::lround(p.x() / kCell_m), std::lround(y / kCell_m));
      }
    }
  }
  return static_cast<double>(cells.size()) * kCell_m * kCell_m;
}

TEST(LiveMesh, LiesOnAWallThatTwoKeyframesSee) {
  Receiver seen;
  seen.add_wall(at(0));
  seen.add_wall({exp_so3({0, 0.1, 0}), {-0.1, 0.05, 0.1}});
  seen.take(true);
  ASSERT_FALSE(seen.pieces().empty());
  for (const auto& p : seen.points()) EXPECT_NEAR(p.z(), kFrontWallZ_m, 0.001);
  EXPECT_GT(seen.area_m2(), 0.95 * seen_m2(seen.poses()));
}

TEST(LiveMesh, HasNormalsTrianglesAndColoursOfTheFreeSide) {
  Receiver seen;
  seen.add_wall(at(0));
  ASSERT_FALSE(seen.pieces().empty());
  for (const auto& [index, piece] : seen.pieces()) {
    const ColoredMesh& mesh = piece.surface.mesh;
    ASSERT_FALSE(mesh.triangles.empty());
    ASSERT_EQ(piece.surface.normals.size(), mesh.points.size());
    ASSERT_EQ(mesh.colors.size(), mesh.points.size());
    for (const auto& normal : piece.surface.normals)
      EXPECT_LT((normal + Eigen::Vector3f::UnitZ()).norm(), 0.01F);
    for (const Rgb& color : mesh.colors) EXPECT_EQ(color, (Rgb{0, 200, 0}));
    for (const auto& [a, b, c] : mesh.triangles)
      EXPECT_LT((mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).z(), 0);
  }
}

/// The mean colour of the vertices with x in a range, in the world.
Eigen::Array3d mean_color(const Receiver& seen, const std::vector<SE3>& poses, double from_x_m,
                          double to_x_m) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  double count = 0;
  for (const auto& [index, piece] : seen.pieces()) {
    const auto& mesh = piece.surface.mesh;
    for (size_t i = 0; i < mesh.points.size(); ++i) {
      const double x_m = (poses[piece.anchor.value] * mesh.points[i].cast<double>()).x();
      if (x_m < from_x_m || x_m > to_x_m) continue;
      sum += Eigen::Array3d(mesh.colors[i][0], mesh.colors[i][1], mesh.colors[i][2]);
      ++count;
    }
  }
  return sum / count;
}

TEST(LiveMesh, ExposureAndWhiteBalanceOfViewsAreThoseOfTheFirst) {
  const cv::Vec3b first(80, 100, 120), brighter(120, 130, 144);  // blue, green, red
  Receiver seen;
  std::vector<SE3> poses;
  for (int i = 0; i < 6; ++i) {
    poses.push_back(at(0.3 * i));
    seen.add(view_of_wall(small_camera(), poses.back(), kFrontWallZ_m, i < 2 ? first : brighter),
             poses.back());
  }
  seen.take(true);
  for (const double x_m : {0.0, 0.5, 1.2}) {
    const Eigen::Array3d color = mean_color(seen, poses, x_m - 0.2, x_m + 0.2);
    EXPECT_LT((color - Eigen::Array3d(120, 100, 80)).abs().maxCoeff(), 3) << x_m << ": " << color.transpose();
  }
}

TEST(ViewGain, IsTheMedianPerChannelOfWellExposedColours) {
  std::vector<ColorPair> pairs(60, {{100, 80, 200}, {150, 80, 100}});
  pairs.insert(pairs.end(), 20, {{60, 60, 60}, {240, 240, 240}});     // something else
  pairs.insert(pairs.end(), 100, {{10, 255, 100}, {200, 200, 200}});  // dark and clipped
  const auto gain = view_gain(pairs);
  ASSERT_TRUE(gain);
  EXPECT_TRUE(gain->isApprox(ColorGain(1.5F, 1, 0.5F)));
}

TEST(ViewGain, NeedsPairsAndIsLimited) {
  const ColorPair dark{{60, 60, 60}, {240, 240, 60}};
  EXPECT_FALSE(view_gain({}));
  EXPECT_FALSE(view_gain(std::vector<ColorPair>(49, dark)));
  const auto gain = view_gain(std::vector<ColorPair>(50, dark));
  ASSERT_TRUE(gain);
  EXPECT_TRUE(gain->isApprox(ColorGain(3, 3, 1)));
}

TEST(LiveMesh, LiesOnBothSidesOfACorner) {
  Receiver seen;
  constexpr double kSideX_m = 0.5;
  for (const double x : {0.0, 0.1}) seen.add(view_of_corner(at(x), kSideX_m), at(x));
  size_t on_wall = 0, on_side = 0;
  for (const auto& p : seen.points()) {
    const bool near_edge = std::abs(p.z() - kFrontWallZ_m) < 0.04 && std::abs(p.x() - kSideX_m) < 0.04;
    const double off_m = std::min(std::abs(p.z() - kFrontWallZ_m), std::abs(p.x() - kSideX_m));
    EXPECT_LT(off_m, near_edge ? 0.02 : 0.004) << p.transpose();
    ++(std::abs(p.z() - kFrontWallZ_m) < std::abs(p.x() - kSideX_m) ? on_wall : on_side);
  }
  EXPECT_GT(on_wall, 500U);
  EXPECT_GT(on_side, 200U);
}

TEST(LiveMesh, ACorrectionChangesNoPiece) {
  Receiver seen;
  for (const double x : {0.0, 0.1, 0.2}) seen.add_wall(at(x));
  seen.take(true);
  for (SE3& pose : seen.poses()) pose = at(0, 0, 1) * pose;
  seen.mesh().correct(seen.poses());
  EXPECT_EQ(seen.take(true), 0U);
  ASSERT_FALSE(seen.points().empty());
  for (const auto& p : seen.points()) EXPECT_NEAR(p.z(), kFrontWallZ_m + 1, 0.001);  // moved by poses alone
}

TEST(LiveMesh, WhatChangedLittleWaits) {
  Receiver seen;
  for (int view = 0; view < 5; ++view) seen.add_wall(at(0));
  EXPECT_EQ(seen.take(false), 0U);  // sent after the views 1 and 3
  EXPECT_GT(seen.take(true), 0U);
  EXPECT_EQ(seen.take(true), 0U);
}

TEST(LiveMesh, SubmapsThatOverlapShowASurfaceOnce) {
  constexpr double kLength_m = 8;
  const Receiver seen = after_walk(kLength_m);
  std::set<KeyframeId> anchors;
  for (const auto& [index, piece] : seen.pieces()) anchors.insert(piece.anchor);
  EXPECT_GE(anchors.size(), 3U);  // a long mesh bends between them
  EXPECT_NEAR(seen.area_m2() / seen_m2(walk(kLength_m)), 1, 0.05);
  // Nor are there gaps between them.
  constexpr double kCell_m = 0.03;
  std::vector<bool> covered(static_cast<size_t>(kLength_m / kCell_m));
  for (const auto& p : seen.points()) {
    const double cell = p.x() / kCell_m;
    if (std::abs(p.y()) < 0.02 && cell >= 0 && cell < static_cast<double>(covered.size()))
      covered[static_cast<size_t>(cell)] = true;
  }
  EXPECT_EQ(std::count(covered.begin(), covered.end(), false), 0);
}

TEST(LiveMesh, AViewThatDisagreesDoesNotSpoilASubmap) {
  Receiver seen;
  for (int view = 0; view < 4; ++view) seen.add_wall(at(0));
  const auto before = seen.pieces();
  ASSERT_FALSE(before.empty());
  // After a round the pose has drifted by 15 cm: the wall seems to be elsewhere.
  seen.add(view_of_wall(small_camera(), at(0), kFrontWallZ_m, kGreen), at(0, 0, 0.15));
  seen.take(true);
  for (const auto& [index, piece] : before)
    EXPECT_EQ(seen.pieces().at(index).surface.mesh.points, piece.surface.mesh.points);
  EXPECT_GT(seen.area_m2(), 1.8 * seen_m2({at(0)}));
  // The loop is closed: both are the same wall, and once it is seen again, one of them shows it.
  seen.poses().back() = at(0);
  seen.add_wall(at(0));
  seen.take(true);
  EXPECT_NEAR(seen.area_m2() / seen_m2({at(0)}), 1, 0.06);
  for (const auto& p : seen.points()) EXPECT_NEAR(p.z(), kFrontWallZ_m, 0.001);
}

TEST(LiveMesh, WhatHasNoDepthLeavesNothing) {
  Receiver seen;
  RgbdImages images = view_of_wall(small_camera(), at(0), kFrontWallZ_m, kGreen);
  images.depth_m.colRange(80, 160) = 0;  // as of what is known to move
  images.depth_m.rowRange(0, 20) = std::numeric_limits<float>::quiet_NaN();
  images.depth_m.rowRange(20, 30) = std::numeric_limits<float>::infinity();
  images.depth_m.rowRange(30, 40) = -1;
  for (int view = 0; view < 3; ++view) seen.add(images, at(0));
  const PinholeCamera camera = small_camera();
  ASSERT_FALSE(seen.points().empty());
  for (const auto& p : seen.points()) {
    const Eigen::Vector2d pixel = camera.project(p);
    EXPECT_LT(pixel.x(), 81);
    EXPECT_GT(pixel.y(), 38);
  }
}

TEST(LiveMesh, OfImagesWithoutDepthIsEmpty) {
  Receiver seen;
  const RgbdImages empty{cv::Mat(120, 160, CV_8UC3, cv::Scalar(0)),
                         cv::Mat(120, 160, CV_32FC1, cv::Scalar(0))};
  for (int view = 0; view < 3; ++view) seen.add(empty, at(0));
  EXPECT_TRUE(seen.pieces().empty());
  EXPECT_EQ(seen.mesh().blocks_in_memory(), 0U);
}

TEST(LiveMesh, WhatIsGoneIsRemoved) {
  Receiver seen;
  RgbdImages with_board = view_of_wall(small_camera(), at(0), kFrontWallZ_m, kGreen);
  with_board.depth_m(cv::Rect(60, 40, 40, 40)) = 0.8F;
  for (int view = 0; view < 3; ++view) seen.add(with_board, at(0));
  const auto on_board = [&] {
    const auto points = seen.points();
    return std::ranges::count_if(points, [](const auto& p) { return p.z() < 1; });
  };
  EXPECT_GT(on_board(), 100);
  for (int view = 0; view < 9; ++view) seen.add_wall(at(0));
  seen.take(true);
  EXPECT_EQ(on_board(), 0);
}

TEST(LiveMesh, KeepsItsMemoryBounded) {
  constexpr double kLength_m = 8;
  const LiveMeshOptions bounded{.voxel_m = 0.02, .max_blocks = 500};
  Receiver seen(bounded);
  size_t most = 0;
  for (const SE3& pose : walk(kLength_m)) {
    seen.add_wall(pose);
    most = std::max(most, seen.mesh().blocks_in_memory());
  }
  seen.take(true);
  EXPECT_LE(most, bounded.max_blocks);
  Receiver unbounded = after_walk(kLength_m);
  EXPECT_GT(unbounded.mesh().blocks_in_memory(), 2 * bounded.max_blocks);
  EXPECT_GT(seen.area_m2(), 0.95 * unbounded.area_m2());  // what was released is still shown
}

TEST(LiveMesh, ASingleViewTakesNoMoreThanItsMemory) {
  const LiveMeshOptions small{.voxel_m = 0.02, .max_blocks = 50};
  Receiver seen(small), unbounded;
  for (Receiver* receiver : {&seen, &unbounded}) receiver->add_wall(at(0));
  EXPECT_GT(unbounded.mesh().blocks_in_memory(), 2 * small.max_blocks);
  EXPECT_EQ(seen.mesh().blocks_in_memory(), small.max_blocks);
}

TEST(LiveMesh, ASubmapIsReleasedAFewPiecesAtATime) {
  constexpr size_t kFew = 2;
  LiveMesh mesh({.voxel_m = 0.02, .max_blocks = 400});
  const DenseCamera camera{.color = small_camera()};
  const std::vector<SE3> poses = walk(6);
  mesh.correct(poses);
  std::set<uint32_t> sent;
  for (uint32_t i = 0; i < poses.size(); ++i) {
    const RgbdImages images = view_of_wall(camera.color, poses[i], kFrontWallZ_m, kGreen);
    mesh.fuse(make_fusion_view(images, camera, undistortion_of(camera.color), {}), KeyframeId{i}, SE3());
    EXPECT_LE(mesh.blocks_in_memory(), 400U);
    for (int turn = 0; turn < 20; ++turn) {
      const auto pieces = mesh.take_changed(kFew, false);
      EXPECT_LE(pieces.size(), kFew);
      for (const MeshPiece& piece : pieces) sent.insert(piece.index);
    }
    EXPECT_LT(mesh.blocks_in_memory(), 400U) << "there is room before it is needed";
  }
  EXPECT_GT(sent.size(), 10U);
}

TEST(LiveMesh, WhatWasReleasedIsNotDrawnAgainWhenItIsSeenAgain) {
  constexpr double kLength_m = 6, kVoxel_m = 0.02;
  Receiver seen({.voxel_m = kVoxel_m, .max_blocks = 300});
  for (const SE3& pose : walk(kLength_m)) seen.add_wall(pose);
  seen.take(true);
  const double once_m2 = seen.area_m2();
  // Depth is a voxel off this time.
  for (const SE3& pose : walk(kLength_m)) seen.add_wall(pose, kFrontWallZ_m + kVoxel_m);
  seen.take(true);
  EXPECT_NEAR(seen.area_m2() / once_m2, 1, 0.05);
}

TEST(LiveMesh, IsTheSameEveryTime) {
  const Receiver a = after_walk(3), b = after_walk(3);
  ASSERT_FALSE(a.pieces().empty());
  ASSERT_EQ(a.pieces().size(), b.pieces().size());
  for (const auto& [index, piece] : a.pieces()) {
    const MeshPiece& other = b.pieces().at(index);
    EXPECT_EQ(piece.anchor, other.anchor);
    EXPECT_EQ(piece.surface.mesh.points, other.surface.mesh.points);
    EXPECT_EQ(piece.surface.mesh.colors, other.surface.mesh.colors);
    EXPECT_EQ(piece.surface.mesh.triangles, other.surface.mesh.triangles);
  }
}

TEST(LiveMesh, RemovesTheDistortionOfTheLens) {
  Receiver seen({.voxel_m = 0.02}, {.color = distorted_camera()});
  for (int view = 0; view < 2; ++view) seen.add_wall(at(0));
  const auto points = seen.points();
  ASSERT_GT(points.size(), 1000U);
  for (const auto& p : points) EXPECT_NEAR(p.z(), kFrontWallZ_m, 0.001);
}

TEST(LiveMesh, DeskewsDelayedDepth) {
  DenseCamera late{.color = small_camera()};
  late.depth_delay_s = 0.04;
  Velocity ahead;
  ahead.linear_m_s.z() = 1;  // m/s: when depth was taken, everything was 4 cm nearer
  const auto mean_z_m = [&](const DenseCamera& camera) {
    Receiver seen({.voxel_m = 0.02}, camera);
    const RgbdImages images = view_of_wall(small_camera(), at(0, 0, 0.04), kFrontWallZ_m, kGreen);
    for (int view = 0; view < 2; ++view) seen.add(images, at(0), ahead);
    double sum_m = 0;
    for (const auto& p : seen.points()) sum_m += p.z();
    return sum_m / static_cast<double>(seen.points().size());
  };
  EXPECT_NEAR(mean_z_m(late), kFrontWallZ_m, 0.001);
  EXPECT_NEAR(mean_z_m({.color = small_camera()}), kFrontWallZ_m - 0.04, 0.001);
}

}  // namespace
}  // namespace kinloop
