#include "tools/export/sparse_model/sparse_model.hpp"

#include <map>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "dense/files/ply.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "tests/support/synthetic_map.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

constexpr size_t kViews = 6;

/// A map of the synthetic world, its images, and a frame without keyframe.
struct Scene {
  test::SyntheticWorld world = test::make_world(2000, 3);
  test::SyntheticMap built;
  ImageStore store;
  std::vector<FrameImage> views;
  FileFrame frame = z_up_frame({0.1, -1, 0.2}, SE3());

  explicit Scene(double sigma_px = 0) {
    for (uint32_t i = 0; i <= kViews; ++i) {
      Vector6d twist;
      twist << 0.08 * i, 0.02 * i, -0.03 * i, 0.01 * i, 0.05 * i, 0;
      const SE3 T_world_camera = SE3::exp(twist);
      const auto view = test::observe(world, T_world_camera, {sigma_px, 0, 0, 0}, i);
      if (i < kViews) add_view(built, world, view, T_world_camera);
      const cv::Mat color(480, 640, CV_8UC3, cv::Scalar(10, 20, 30 + 10 * i));
      const cv::Mat depth_m(480, 640, CV_32FC1, cv::Scalar(1 + 0.1 * i));
      store.add({color, depth_m});
      views.push_back({FrameId{i}, {i, T_world_camera}});
    }
  }

  [[nodiscard]] ImageUndistorter undistorter() const {
    DenseCamera camera;
    camera.color = world.camera;
    return ImageUndistorter(camera);
  }
  [[nodiscard]] SparseModel model() const {
    return make_sparse_model(built.map, views, undistorter(), frame);
  }
};

/// COLMAP's files as read by their specification.
struct ReadImage {
  SE3 T_camera_world;
  std::string name;
  std::vector<std::pair<Eigen::Vector2d, int64_t>> points2d;
};
struct ReadPoint {
  Eigen::Vector3d p;
  double error = 0;
  std::vector<std::pair<int, size_t>> track;
};
struct ReadModel {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  int width = 0, height = 0;
  std::map<int, ReadImage> images;
  std::map<int64_t, ReadPoint> points;
};

std::vector<std::string> data_lines(const std::filesystem::path& path) {
  std::istringstream text(read_file(path));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with('#')) lines.push_back(line);
  }
  return lines;
}

ReadModel read_colmap(const std::filesystem::path& folder) {
  ReadModel model;
  std::string kind;
  int camera = 0;
  std::istringstream(data_lines(folder / "cameras.txt").at(0)) >> camera >> kind >> model.width >>
      model.height >> model.fx >> model.fy >> model.cx >> model.cy;
  EXPECT_EQ(kind, "PINHOLE");
  const auto lines = data_lines(folder / "images.txt");
  for (size_t i = 0; i + 1 < lines.size(); i += 2) {
    int id = 0;
    ReadImage image;
    auto& [q, t] = image.T_camera_world;
    std::istringstream(lines[i]) >> id >> q.w() >> q.x() >> q.y() >> q.z() >> t.x() >> t.y() >> t.z() >>
        camera >> image.name;
    EXPECT_EQ(camera, 1);
    std::istringstream points(lines[i + 1]);
    int64_t point = 0;
    for (double x = 0, y = 0; points >> x >> y >> point;) image.points2d.push_back({{x, y}, point});
    model.images[id] = image;
  }
  for (const std::string& line : data_lines(folder / "points3D.txt")) {
    std::istringstream words(line);
    int64_t id = 0;
    int red = 0, green = 0, blue = 0, image = 0;
    ReadPoint point;
    words >> id >> point.p.x() >> point.p.y() >> point.p.z() >> red >> green >> blue >> point.error;
    for (size_t index = 0; words >> image >> index;) point.track.emplace_back(image, index);
    model.points[id] = point;
  }
  return model;
}

TEST(ColmapModel, EveryPointReprojectsIntoItsImagesAndIdsAgreeBothWays) {
  constexpr double kSigmaPx = 0.5;
  const test::TempFolder folder;
  const Scene scene(kSigmaPx);
  write_colmap_model(folder.path(), scene.model());
  const ReadModel read = read_colmap(folder.path() / "sparse/0");
  ASSERT_EQ(read.images.size(), kViews + 1);
  ASSERT_GT(read.points.size(), 100U);
  EXPECT_EQ(read.cx, 320) << "the centre of the top left pixel is (0.5, 0.5)";
  size_t elements = 0, observations = 0;
  double sum_px = 0;
  for (const auto& [id, point] : read.points) {
    EXPECT_GE(point.track.size(), 2U);
    std::set<int> images;
    double error_px = 0;
    for (const auto& [image_id, index] : point.track) {
      const ReadImage& image = read.images.at(image_id);
      const auto& [pixel, point_id] = image.points2d.at(index);
      EXPECT_EQ(point_id, id);
      EXPECT_TRUE(images.insert(image_id).second);
      const Eigen::Vector3d p = image.T_camera_world * point.p;
      const Eigen::Vector2d projected(read.fx * p.x() / p.z() + read.cx, read.fy * p.y() / p.z() + read.cy);
      EXPECT_LE((projected - pixel).norm(), kMaxReprojectionErrorPx + 0.01);
      error_px += (projected - pixel).norm();
    }
    elements += point.track.size();
    sum_px += error_px;
    EXPECT_NEAR(point.error, error_px / static_cast<double>(point.track.size()), 0.01);
  }
  for (const auto& [id, image] : read.images) observations += image.points2d.size();
  EXPECT_EQ(observations, elements);
  EXPECT_LT(sum_px / static_cast<double>(elements), 3 * kSigmaPx);
}

TEST(ColmapModel, LeavesOutUnusablePosesPointsAndOutliers) {
  Scene scene;
  const size_t points = scene.model().points.size();
  scene.views[2].view.T_world_camera.translation.x() = std::numeric_limits<double>::quiet_NaN();
  const SparseModel without = scene.model();
  EXPECT_EQ(without.images.size(), kViews);
  ASSERT_FALSE(without.points.empty());
  for (const ModelPoint& point : without.points) EXPECT_TRUE(point.p_file.allFinite());
  // A pose that is wrong by far agrees with nothing.
  scene = Scene();
  scene.views[1].view.T_world_camera.translation.x() += 1;
  const SparseModel model = scene.model();
  EXPECT_LT(model.points.size(), points);
  EXPECT_GT(model.points.size(), 0U);
}

TEST(ColmapModel, AMapWithoutImagesGivesAnEmptyModel) {
  Scene scene;
  scene.views.clear();
  EXPECT_TRUE(scene.model().images.empty());
  EXPECT_TRUE(scene.model().points.empty());
}

TEST(ColmapModel, TakesPointsOfTheCloudAtRandomAndEachOnce) {
  constexpr size_t kPoints = 1000, kAsked = 100;
  const Scene scene;
  ColoredCloud cloud;
  for (uint16_t i = 0; i < kPoints; ++i) {
    cloud.points.emplace_back(0.01F * i, 1, 2);
    cloud.colors.push_back({static_cast<uint8_t>(i % 256), 7, 9});
  }
  SparseModel model = scene.model();
  const size_t landmarks = model.points.size();
  add_cloud_points(model, cloud, kAsked);
  ASSERT_EQ(model.points.size(), landmarks + kAsked);
  const SE3 T_world_file = model.frame.T_file_world().inverse();
  std::set<long> taken;
  for (size_t i = landmarks; i < model.points.size(); ++i) {
    const Eigen::Vector3d p_world = T_world_file * model.points[i].p_file;
    const long index = std::lround(p_world.x() / 0.01);
    EXPECT_NEAR(p_world.y(), 1, 1e-6);
    EXPECT_EQ(model.points[i].color[0], index % 256);
    taken.insert(index);
  }
  EXPECT_EQ(taken.size(), kAsked);
  EXPECT_LT(*taken.begin(), 100);
  EXPECT_GT(*taken.rbegin(), 900);

  const test::TempFolder folder;
  write_model_images(folder.path(), model, scene.store, scene.undistorter(), {});
  EXPECT_EQ(model.points.back().color[1], 7) << "a point of the cloud keeps its colour";
  model = scene.model();
  add_cloud_points(model, cloud, 2 * kPoints);
  EXPECT_EQ(model.points.size(), landmarks + kPoints) << "all that there are";
}

TEST(NerfstudioModel, HasTheSamePosesWithAxesOfOpenGL) {
  const test::TempFolder folder;
  const Scene scene;
  write_nerfstudio(folder.path(), scene.model());
  const auto transforms = nlohmann::json::parse(read_file(folder.path() / "transforms.json"));
  ASSERT_EQ(transforms["frames"].size(), kViews + 1);
  EXPECT_EQ(transforms["w"], 640);
  EXPECT_EQ(transforms["cx"], 320);
  for (size_t i = 0; i < transforms["frames"].size(); ++i) {
    Eigen::Matrix4d T;
    for (int row = 0; row < 4; ++row) {
      for (int col = 0; col < 4; ++col)
        T(row, col) = transforms["frames"][i]["transform_matrix"][row][col].get<double>();
    }
    // What is ahead of and above the camera, in both conventions.
    const SE3 T_file_camera =
        SE3{scene.frame.R_file_world, Eigen::Vector3d::Zero()} * scene.views[i].view.T_world_camera;
    const Eigen::Vector3d expected = T_file_camera * Eigen::Vector3d(0.5, -0.7, 2);
    EXPECT_LT(((T * Eigen::Vector4d(0.5, 0.7, -2, 1)).head<3>() - expected).norm(), 1e-9);
  }
  const ColoredCloud cloud = read_ply(folder.path() / transforms["ply_file_path"].get<std::string>());
  const SparseModel model = scene.model();
  ASSERT_EQ(cloud.size(), model.points.size());
  const Eigen::Vector3d p_world = scene.frame.R_file_world.conjugate() * model.points[7].p_file;
  EXPECT_LT((cloud.points[7].cast<double>() - p_world).norm(), 1e-6);
}

TEST(ModelImages, KeepsPinholeImagesAndColorsThePoints) {
  const test::TempFolder folder;
  const Scene scene;
  SparseModel model = scene.model();
  write_model_images(folder.path(), model, scene.store, scene.undistorter(), {true, 2});
  for (size_t i = 0; i <= kViews; ++i) {
    const std::string name = model.images[i].name;
    const auto& jpeg = scene.store.encoded(i).color;
    EXPECT_TRUE(read_file(folder.path() / "images" / (name + ".jpg")) ==
                std::string(jpeg.begin(), jpeg.end()));
    const cv::Mat depth =
        cv::imread((folder.path() / "depth" / (name + ".png")).string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(depth.type(), CV_16UC1);
    EXPECT_EQ(depth.at<uint16_t>(100, 200), 1000 + 100 * i);
  }
  ASSERT_FALSE(model.points.empty());
  for (const ModelPoint& point : model.points) {
    double red = 0;
    for (const TrackElement& element : point.track) red += 30 + 10 * element.image;
    EXPECT_NEAR(point.color[0], red / static_cast<double>(point.track.size()), 3);
    EXPECT_NEAR(point.color[2], 10, 3);
  }
}

}  // namespace
}  // namespace kinloop
