#include <cmath>

#include <gmock/gmock.h>
#include <opencv2/imgproc.hpp>

#include "dense/cloud/color_gains.hpp"
#include "dense/cloud/point_colors.hpp"
#include "dense/sharpness.hpp"
#include "dense/texture/atlas/atlas_layout.hpp"
#include "dense/texture/choose_views.hpp"
#include "dense/texture/texture_mesh.hpp"
#include "dense/texture/view_candidates.hpp"
#include "kinloop/core/random.hpp"
#include "tests/dense/plane_view.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::small_camera;
using testing::HasSubstr;

constexpr double kStripedWallZ_m = 1.5;

/// Red, green and blue of the wall: stripes of 9 cm, which are gray, since JPEG halves the resolution of
/// hues, and slow changes; between 60 and 180.
Eigen::Vector3d stripe_color(const Eigen::Vector3d& p) {
  constexpr double kWave = 2 * M_PI / 0.09, kSlow = 3;
  const double gray = 120 + 25 * std::sin(kWave * p.x()) + 20 * std::sin(kWave * p.y() + 1);
  return {gray, gray + 10 * std::sin(kSlow * p.x()), gray - 10 * std::cos(kSlow * p.y())};
}

/// A wall as a grid of large triangles around the axis of the world.
ColoredMesh wall_mesh(int cells, double cell_m) {
  ColoredMesh mesh;
  const auto side = static_cast<uint32_t>(cells + 1);
  for (uint32_t row = 0; row < side; ++row) {
    for (uint32_t col = 0; col < side; ++col) {
      const auto at = [&](uint32_t i) { return (static_cast<double>(i) - cells / 2.0) * cell_m; };
      mesh.points.push_back(Eigen::Vector3d(at(col), at(row), kStripedWallZ_m).cast<float>());
      if (row + 1 == side || col + 1 == side) continue;
      const uint32_t first = row * side + col;
      mesh.triangles.push_back({first, first + side, first + 1});
      mesh.triangles.push_back({first + 1, first + side, first + side + 1});
    }
  }
  mesh.colors.resize(mesh.points.size(), {10, 20, 30});
  return mesh;
}

/// Images of the wall.
struct StripedScene {
  DenseCamera camera{.color = small_camera()};
  ImageStore images{{.jpeg_quality = 100}};
  std::vector<PosedImage> views;

  /// A view by a camera that moves while it reads its rows; `exposure` multiplies the colours.
  void add(const SE3& T_world_camera, double exposure = 1, const Velocity& velocity = {}) {
    RgbdImages seen = test::view_of_wall(camera.color, T_world_camera, kStripedWallZ_m, {});
    for (int row = 0; row < seen.color.rows; ++row) {
      const double time_s = camera.color_readout_s * (static_cast<double>(row) / camera.color.height - 0.5);
      const SE3 pose = propagate_pose(T_world_camera, velocity, time_s);
      for (int col = 0; col < seen.color.cols; ++col) {
        const Eigen::Vector3d ray = pose.rotation * camera.color.unproject(Eigen::Vector2d(col, row), 1);
        const double distance = (kStripedWallZ_m - pose.translation.z()) / ray.z();
        const Eigen::Vector3d rgb = exposure * stripe_color(pose.translation + distance * ray);
        for (int k = 0; k < 3; ++k)
          seen.color.at<cv::Vec3b>(row, col)[k] = cv::saturate_cast<uint8_t>(rgb(2 - k));
      }
    }
    views.push_back({images.add(seen), T_world_camera, velocity});
  }

  void compensate_exposure() {
    const SurfelLoader surfels = [this](size_t i) {
      return extract_surfels(images.load(i), {camera.color.fx}, {});
    };
    const auto gains = color_gains(surfels, views, camera, 1);
    for (size_t i = 0; i < views.size(); ++i) views[i].color_gain = gains[i];
  }

  [[nodiscard]] MeshTexture texture(const ColoredMesh& mesh, int max_size_px = 1024, int threads = 1) const {
    return texture_mesh(mesh, {images, views, camera}, max_size_px, threads);
  }
};

SE3 camera_at_x(double x_m) {
  return {Eigen::Quaterniond::Identity(), {x_m, 0, 0}};
}

/// The pixel of a texture, by bilinear interpolation: red, green, blue.
Eigen::Vector3d pixel_at(const cv::Mat& image, const Eigen::Vector2f& uv) {
  cv::Mat pixel;
  const cv::Point2f center(uv.x() * static_cast<float>(image.cols) - 0.5F,
                           uv.y() * static_cast<float>(image.rows) - 0.5F);
  cv::getRectSubPix(image, {1, 1}, center, pixel);
  const auto& bgr = pixel.at<cv::Vec3b>(0, 0);
  return {static_cast<double>(bgr[2]), static_cast<double>(bgr[1]), static_cast<double>(bgr[0])};
}

/// Calls `use(point, shares of the corners)` at places inside a triangle.
template <class Use>
void for_each_place(const Use& use) {
  constexpr int kSteps = 5;
  for (int i = 1; i < kSteps; ++i) {
    for (int k = 1; k < kSteps - i; ++k) {
      const auto b = static_cast<float>(i) / kSteps, c = static_cast<float>(k) / kSteps;
      use(Eigen::Vector3f(1 - b - c, b, c));
    }
  }
}

/// RMS over the mesh of the difference between shown colours and those of the wall.
template <class Show>
double rms_error(const ColoredMesh& mesh, const Show& shown) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    for_each_place([&](const Eigen::Vector3f& shares) {
      Eigen::Vector3f point = Eigen::Vector3f::Zero();
      for (int k = 0; k < 3; ++k) point += shares(k) * mesh.points[mesh.triangles[i][static_cast<size_t>(k)]];
      sum += (shown(i, shares) - stripe_color(point.cast<double>())).squaredNorm() / 3;
      count += 1;
    });
  }
  return std::sqrt(sum / count);
}

double rms_error(const ColoredMesh& mesh, const MeshTexture& texture) {
  return rms_error(mesh, [&](size_t triangle, const Eigen::Vector3f& shares) {
    Eigen::Vector2f uv = Eigen::Vector2f::Zero();
    for (int k = 0; k < 3; ++k)
      uv += shares(k) * texture.uvs[texture.triangles[triangle][static_cast<size_t>(k)]];
    return pixel_at(texture.image, uv);
  });
}

double rms_error_of_vertices(const ColoredMesh& mesh) {
  return rms_error(mesh, [&](size_t triangle, const Eigen::Vector3f& shares) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const Rgb& rgb = mesh.colors[mesh.triangles[triangle][static_cast<size_t>(k)]];
      sum += static_cast<double>(shares(k)) * Eigen::Vector3d(rgb[0], rgb[1], rgb[2]);
    }
    return sum;
  });
}

TEST(TextureMesh, ShowsAWallOfTwoExposuresBetterThanVertexColours) {
  StripedScene scene;
  constexpr double kExposure = 1.2;
  scene.add(camera_at_x(-0.3), kExposure);
  scene.add(camera_at_x(0.3), 1 / kExposure);
  scene.compensate_exposure();
  ColoredMesh mesh = wall_mesh(12, 0.1);
  mesh.colors = color_points(mesh.points, vertex_normals(mesh), {scene.images, scene.views, scene.camera}, 1);
  const MeshTexture texture = scene.texture(mesh);
  EXPECT_EQ(texture.unseen_triangles, 0U);
  EXPECT_EQ(texture.charts, 2U) << "one of each view";
  const double error = rms_error(mesh, texture), of_vertices = rms_error_of_vertices(mesh);
  EXPECT_LT(error, 5);
  EXPECT_GT(of_vertices, 20);

  for (PosedImage& view : scene.views) view.color_gain.setOnes();
  EXPECT_LT(error, 0.5 * rms_error(mesh, scene.texture(mesh)));
}

TEST(TextureMesh, LevelsTheSeamsThatGainsLeave) {
  StripedScene scene;
  scene.add(camera_at_x(-0.3), 1.1);
  scene.add(camera_at_x(0.3), 1 / 1.1);
  const ColoredMesh mesh = wall_mesh(12, 0.1);
  const MeshTexture texture = scene.texture(mesh);
  // Along the seam, both sides show nearly the same; without levelling they would differ by a fifth.
  size_t seam_vertices = 0;
  double difference = 0;
  std::vector<int> first_uv(mesh.points.size(), -1);
  for (uint32_t i = 0; i < texture.uvs.size(); ++i) {
    int& first = first_uv[texture.vertex_of_uv[i]];
    if (first < 0) {
      first = static_cast<int>(i);
      continue;
    }
    ++seam_vertices;
    difference += (pixel_at(texture.image, texture.uvs[i]) -
                   pixel_at(texture.image, texture.uvs[static_cast<size_t>(first)]))
                      .cwiseAbs()
                      .mean();
  }
  ASSERT_GT(seam_vertices, 8U);
  EXPECT_LT(difference / static_cast<double>(seam_vertices), 4);
}

TEST(TextureMesh, FollowsTheLensAndTheRollingShutter) {
  Velocity turning;
  turning.angular_rad_s = {0.3, 0.8, 0};
  turning.linear_m_s = {0.3, 0, 0};
  StripedScene scene;
  scene.camera.color_readout_s = 0.03;
  scene.add(camera_at_x(0), 1, turning);
  const ColoredMesh mesh = wall_mesh(8, 0.1);
  const double error = rms_error(mesh, scene.texture(mesh));
  EXPECT_LT(error, 5);
  scene.camera.color_readout_s = 0;
  EXPECT_GT(rms_error(mesh, scene.texture(mesh)), 2 * error);

  StripedScene distorted;
  distorted.camera.color = test::distorted_camera();
  RgbdImages seen = test::view_of_wall(distorted.camera.color, {}, kStripedWallZ_m, {});
  for (int row = 0; row < seen.color.rows; ++row) {
    for (int col = 0; col < seen.color.cols; ++col) {
      const Eigen::Vector2d ideal = distorted.camera.color.undistort(Eigen::Vector2d(col, row));
      const Eigen::Vector3d rgb = stripe_color(distorted.camera.color.unproject(ideal, kStripedWallZ_m));
      for (int k = 0; k < 3; ++k)
        seen.color.at<cv::Vec3b>(row, col)[k] = cv::saturate_cast<uint8_t>(rgb(2 - k));
    }
  }
  distorted.views.push_back({distorted.images.add(seen), {}});
  EXPECT_LT(rms_error(mesh, distorted.texture(mesh)), 5);
}

TEST(TextureMesh, LargeTrianglesAreInPerspective) {
  StripedScene scene;
  scene.add({exp_so3({0, 0.5, 0}), {-0.6, 0, 0}});
  const ColoredMesh mesh = wall_mesh(1, 0.6);
  ASSERT_EQ(scene.texture(mesh).unseen_triangles, 0U);
  EXPECT_LT(rms_error(mesh, scene.texture(mesh)), 8);
}

TEST(TextureMesh, TakesNoColourFromWhatStoodBefore) {
  StripedScene scene;
  scene.add(camera_at_x(0));
  scene.add(camera_at_x(0.05));
  // Someone stands before the middle of the sharper of both views.
  RgbdImages hidden = scene.images.load(0);
  const cv::Rect middle(60, 40, 40, 40);
  hidden.color(middle).setTo(cv::Scalar::all(0));
  hidden.depth_m(middle).setTo(0.8F);
  scene.views[0].image = scene.images.add(hidden);
  const ColoredMesh mesh = wall_mesh(10, 0.08);
  const MeshTexture texture = scene.texture(mesh);
  EXPECT_EQ(texture.unseen_triangles, 0U);
  EXPECT_LT(rms_error(mesh, texture), 6);
}

TEST(TextureMesh, WhatNoViewSeesAsAWholeIsColouredByPointsElseByVertices) {
  StripedScene scene;
  scene.add(camera_at_x(0));
  ColoredMesh mesh = wall_mesh(1, 3);  // larger than the image
  const MeshTexture texture = scene.texture(mesh);
  EXPECT_EQ(texture.unseen_triangles, mesh.triangles.size());
  EXPECT_EQ(texture.charts, 0U);
  const auto shown = [&](const Eigen::Vector3f& shares) {
    Eigen::Vector2f uv = Eigen::Vector2f::Zero();
    for (int k = 0; k < 3; ++k) uv += shares(k) * texture.uvs[texture.triangles[0][static_cast<size_t>(k)]];
    return pixel_at(texture.image, uv);
  };
  const auto& [a, b, c] = mesh.triangles[0];
  const Eigen::Vector3f near_axis(0.02F, 0.49F, 0.49F);
  const Eigen::Vector3f point = 0.02F * mesh.points[a] + 0.49F * mesh.points[b] + 0.49F * mesh.points[c];
  EXPECT_LT((shown(near_axis) - stripe_color(point.cast<double>())).norm(), 40);
  EXPECT_LT((shown({0.98F, 0.01F, 0.01F}) - Eigen::Vector3d(10, 20, 30)).norm(), 3);
}

TEST(TextureMesh, DoesNotDependOnThreads) {
  StripedScene scene;
  for (const double x : {-0.3, 0.0, 0.3}) scene.add(camera_at_x(x), 1 + x / 10);
  const ColoredMesh mesh = wall_mesh(16, 0.1);
  const MeshTexture one = scene.texture(mesh, 256, 1), three = scene.texture(mesh, 256, 3);
  EXPECT_EQ(one.uvs, three.uvs);
  EXPECT_EQ(one.triangles, three.triangles);
  EXPECT_EQ(cv::norm(one.image, three.image, cv::NORM_INF), 0);
}

TEST(TextureMesh, IsScaledToTheSizeThatIsAskedFor) {
  StripedScene scene;
  scene.add(camera_at_x(0));
  const ColoredMesh mesh = wall_mesh(8, 0.1);
  EXPECT_EQ(scene.texture(mesh).scale, 1);
  const MeshTexture small = scene.texture(mesh, kMinTexturePx);
  EXPECT_LE(std::max(small.image.cols, small.image.rows), kMinTexturePx);
  EXPECT_GT(small.image.cols, kMinTexturePx * 8 / 10);
  EXPECT_LT(small.scale, 1);
  // Stripes of 9 cm are some 6 pixels wide then.
  EXPECT_LT(rms_error(mesh, small), 20);
  MeshOptions options;
  options.texture_px = kMinTexturePx - 1;
  EXPECT_THAT(test::usage_error([&] {
                reconstruct_textured_mesh({scene.images, scene.views, scene.camera}, options, 1);
              }),
              HasSubstr("at least 64"));
}

TEST(TextureMesh, AMeshWithoutTrianglesOrViewsHasATexture) {
  const StripedScene scene;
  EXPECT_EQ(scene.texture({}).triangles.size(), 0U);
  const ColoredMesh mesh = wall_mesh(1, 0.2);
  const MeshTexture texture = scene.texture(mesh);
  EXPECT_EQ(texture.unseen_triangles, 2U);
  EXPECT_LT((pixel_at(texture.image, texture.uvs[0]) - Eigen::Vector3d(10, 20, 30)).norm(), 2);
}

TEST(AtlasLayout, TrianglesAreInsideTheirChartsWhichDoNotOverlap) {
  const ColoredMesh mesh = wall_mesh(12, 0.08);
  const std::vector<PosedImage> views = {{0, camera_at_x(-0.2)}, {1, camera_at_x(0.2)}, {2, camera_at_x(0)}};
  std::vector<uint32_t> chosen;
  Random random(5);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto view = static_cast<uint32_t>(random.index(4));
    chosen.push_back(view == 3 ? kNoView : view);
  }
  for (const int max_size_px : {1024, 200}) {
    const AtlasLayout layout = lay_out_atlas(mesh, chosen, views, small_camera(), max_size_px);
    EXPECT_LE(std::max(layout.size.width, layout.size.height), max_size_px);
    ASSERT_EQ(layout.triangles.size(), mesh.triangles.size());
    for (size_t i = 0; i < layout.triangles.size(); ++i) {
      const cv::Rect& chart = layout.charts[layout.chart_of_triangle[i]];
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t corner = layout.triangles[i][k];
        const Eigen::Vector2f px = layout.corners_px[corner];
        EXPECT_EQ(layout.vertex_of_corner[corner], mesh.triangles[i][k]);
        const auto inside = [](float value, int low, int size) {
          return value >= static_cast<float>(low + kAtlasMarginPx) &&
                 value <= static_cast<float>(low + size - 1 - kAtlasMarginPx);
        };
        EXPECT_TRUE(inside(px.x(), chart.x, chart.width) && inside(px.y(), chart.y, chart.height)) << i;
      }
    }
    const cv::Rect atlas({}, layout.size);
    ASSERT_GE(layout.charts.size(), views.size());
    for (size_t i = 0; i < layout.charts.size(); ++i) {
      EXPECT_EQ(layout.charts[i] & atlas, layout.charts[i]);
      for (size_t k = 0; k < i; ++k)
        EXPECT_EQ((layout.charts[i] & layout.charts[k]).area(), 0) << i << ' ' << k;
    }
  }
  EXPECT_THAT(test::usage_error([&] { lay_out_atlas(mesh, chosen, views, small_camera(), 64); }),
              testing::AllOf(HasSubstr("mesh.texture_px is 64"), HasSubstr("--texture 128")));
}

TEST(PackRectangles, TheyDoNotOverlapAndWasteLittle) {
  Random random(11);
  std::vector<cv::Size> sizes;
  int area = 0;
  for (int i = 0; i < 300; ++i) {
    sizes.emplace_back(1 + static_cast<int>(random.index(40)), 1 + static_cast<int>(random.index(60)));
    area += sizes.back().area();
  }
  constexpr int kWidth = 500;
  const auto packed = pack_rectangles(sizes, kWidth);
  ASSERT_TRUE(packed);
  cv::Mat covered = cv::Mat::zeros(packed->height, kWidth, CV_8UC1);
  for (size_t i = 0; i < sizes.size(); ++i) {
    const cv::Rect place(packed->corners[i], sizes[i]);
    ASSERT_EQ(place & cv::Rect({}, covered.size()), place);
    EXPECT_EQ(cv::countNonZero(covered(place)), 0) << i;
    covered(place).setTo(1);
  }
  EXPECT_GT(area, 0.85 * covered.size().area());
  EXPECT_FALSE(pack_rectangles(sizes, 39));
  EXPECT_EQ(pack_rectangles({}, 10)->height, 0);
}

/// A strip of triangles of 1 cm, 2 cm long each.
ColoredMesh strip(uint32_t triangles) {
  ColoredMesh mesh;
  for (uint32_t i = 0; i < triangles + 2; ++i)
    mesh.points.emplace_back(0.01F * static_cast<float>(i), 0.01F * static_cast<float>(i % 2), 0.0F);
  for (uint32_t i = 0; i < triangles; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  return mesh;
}

ViewCandidate seen_by(uint32_t view, float quality) {
  ViewCandidate candidate;
  candidate.view = view;
  candidate.quality = quality;
  return candidate;
}

TEST(ChooseViews, FewSeamsUnlessTheyArePaidFor) {
  constexpr uint32_t kCount = 40;
  const ColoredMesh mesh = strip(kCount);
  ViewCandidates candidates(kCount);
  for (uint32_t i = 0; i < kCount; ++i) {  // alternately a little better
    candidates[i] = {seen_by(3, i % 2 == 0 ? 1.1F : 1.0F), seen_by(7, 1.05F)};
  }
  auto chosen = choose_views(mesh, candidates);
  ASSERT_EQ(chosen.size(), kCount);
  for (const uint32_t view : chosen) EXPECT_EQ(view, chosen.front());

  for (uint32_t i = 0; i < kCount; ++i) candidates[i][i < 15 ? 0 : 1].quality = 1e6F;  // clearly better
  chosen = choose_views(mesh, candidates);
  for (uint32_t i = 0; i < kCount; ++i) EXPECT_EQ(chosen[i], i < 15 ? 3U : 7U) << i;

  candidates[20].clear();
  candidates[21] = {seen_by(9, 1)};
  chosen = choose_views(mesh, candidates);
  EXPECT_EQ(chosen[20], kNoView);
  EXPECT_EQ(chosen[21], 9U);
  EXPECT_EQ(chosen[22], 7U);
}

TEST(ChooseViews, AreAsGoodAsAllCombinations) {
  constexpr uint32_t kCount = 9;
  const ColoredMesh mesh = strip(kCount);
  Random random(3);
  for (int round = 0; round < 10; ++round) {
    ViewCandidates candidates(kCount);
    for (auto& of_triangle : candidates) {
      for (const uint32_t view : {0U, 1U})
        of_triangle.push_back(seen_by(view, static_cast<float>(std::exp(4 * random.gaussian()))));
    }
    const auto cost = [&](const auto& view_of) {
      double sum = 0;
      for (uint32_t i = 0; i < kCount; ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        const float area =
            (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).norm() / 2;
        const float best = std::max(candidates[i][0].quality, candidates[i][1].quality);
        sum += area * std::log(best / candidates[i][view_of(i)].quality);
        constexpr float kSeamCostM = 0.03F;
        if (i > 0 && view_of(i) != view_of(i - 1))
          sum += kSeamCostM * (mesh.points[i] - mesh.points[i + 1]).norm();
      }
      return sum;
    };
    double best = 1e9;
    for (uint32_t bits = 0; bits < 1U << kCount; ++bits)
      best = std::min(best, cost([&](uint32_t i) { return (bits >> i) & 1U; }));
    const auto chosen = choose_views(mesh, candidates);
    EXPECT_NEAR(cost([&](uint32_t i) { return chosen[i]; }), best, 1e-7) << round;
  }
}

TEST(RenderDepth, TheNearestSurfaceCounts) {
  ColoredMesh mesh = wall_mesh(4, 0.3);
  const auto first = static_cast<uint32_t>(mesh.points.size());
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(0, -1, 1), Eigen::Vector3f(0, 1, 1), Eigen::Vector3f(1, 0, 1)})
    mesh.points.push_back(p);
  mesh.triangles.push_back({first, first + 1, first + 2});
  const cv::Mat depth_m = render_depth(mesh, camera_at_x(0.1).inverse(), small_camera());
  EXPECT_NEAR(depth_m.at<float>(60, 40), kStripedWallZ_m, 1e-5);
  EXPECT_NEAR(depth_m.at<float>(60, 90), 1, 1e-5);
  EXPECT_TRUE(std::isinf(depth_m.at<float>(2, 2)));
}

TEST(FineContrast, FallsWithBlurNotWithContrast) {
  cv::Mat sharp(120, 160, CV_8UC3), blurred;
  Random random(4);
  for (auto pixel = sharp.begin<cv::Vec3b>(); pixel != sharp.end<cv::Vec3b>(); ++pixel) {
    const auto value = static_cast<uint8_t>(40 + random.index(160));
    *pixel = {value, value, value};
  }
  cv::GaussianBlur(sharp, sharp, {5, 5}, 0);
  cv::blur(sharp, blurred, {7, 1});  // as by a camera that turns
  EXPECT_LT(fine_contrast(blurred), 0.8F * fine_contrast(sharp));
  EXPECT_NEAR(fine_contrast(0.5 * sharp), fine_contrast(sharp), 0.05);
  EXPECT_EQ(fine_contrast(cv::Mat(20, 20, CV_8UC3, cv::Scalar::all(90))), 0.0F);
}

}  // namespace
}  // namespace kinloop
