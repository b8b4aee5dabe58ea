#include "apps/reproduce/board_stills.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/sensor/images/image_file.hpp"

namespace kinloop {
namespace {

constexpr int kBoardColumns = 5, kBoardRows = 7;
constexpr double kSquareM = 0.03;
constexpr int kSamplesPerSide = 3;  ///< of a pixel
constexpr double kStillNoise = 2;   ///< standard deviation, grey levels

/// Directions of all samples of all pixels, which are the same in every still.
std::vector<Eigen::Vector3d> sample_rays(const PinholeCamera& camera) {
  std::vector<Eigen::Vector3d> rays;
  for (int y = 0; y < camera.height * kSamplesPerSide; ++y) {
    for (int x = 0; x < camera.width * kSamplesPerSide; ++x) {
      const Eigen::Vector2d pixel((x + 0.5) / kSamplesPerSide - 0.5, (y + 0.5) / kSamplesPerSide - 0.5);
      rays.push_back(camera.unproject(camera.undistort(pixel), 1));
    }
  }
  return rays;
}

/// A pose in view: 20 to 40 degrees to a side, near enough to cover much of the image.
SE3 board_pose(Random& random) {
  const double side = random.uniform(0, 2 * std::numbers::pi);
  const double tilt = random.uniform(20, 40) * std::numbers::pi / 180;
  const Eigen::Quaterniond rotation =
      exp_so3({tilt * std::cos(side), tilt * std::sin(side), random.uniform(-0.3, 0.3)});
  const double z = random.uniform(0.35, 0.6);
  const Eigen::Vector3d middle(random.uniform(-0.45, 0.45) * z, random.uniform(-0.2, 0.2) * z, z);
  const Eigen::Vector3d own_middle((kBoardColumns - 1) * kSquareM / 2, (kBoardRows - 1) * kSquareM / 2, 0);
  return {rotation, middle - rotation * own_middle};
}

/// 1 white, 0 black, at a point of the board's plane.
double brightness(double x_m, double y_m) {
  const int column = static_cast<int>(std::floor(x_m / kSquareM)),
            row = static_cast<int>(std::floor(y_m / kSquareM));
  const bool on_board = column >= -1 && column < kBoardColumns && row >= -1 && row < kBoardRows;
  return on_board && (column + row) % 2 == 0 ? 0 : 1;
}

cv::Mat draw_board(const PinholeCamera& camera, const std::vector<Eigen::Vector3d>& rays,
                   const SE3& T_camera_board, Random& random) {
  const SE3 T_board_camera = T_camera_board.inverse();
  cv::Mat sums(camera.height, camera.width, CV_64FC1, cv::Scalar(0));
  for (size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d ray = T_board_camera.rotation * rays[i];
    const Eigen::Vector3d p = T_board_camera.translation - T_board_camera.translation.z() / ray.z() * ray;
    const size_t width = static_cast<size_t>(camera.width) * kSamplesPerSide;
    sums.at<double>(static_cast<int>(i / width) / kSamplesPerSide,
                    static_cast<int>(i % width) / kSamplesPerSide) += brightness(p.x(), p.y());
  }
  cv::Mat image(camera.height, camera.width, CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double share = sums.at<double>(y, x) / (kSamplesPerSide * kSamplesPerSide);
      image.at<uint8_t>(y, x) =
          cv::saturate_cast<uint8_t>(40 + 180 * share + kStillNoise * random.gaussian());
    }
  }
  return image;
}

}  // namespace

PinholeCamera simulated_board_camera() {
  PinholeCamera camera;
  camera.width = 960, camera.height = 540;
  camera.fx = 532, camera.fy = 533.5, camera.cx = 491.5, camera.cy = 265;
  camera.lens.k1 = 0.03, camera.lens.k2 = 0.02, camera.lens.p1 = 0.0005, camera.lens.p2 = -0.002;
  return camera;
}

void draw_board_stills(const std::filesystem::path& folder, int count) {
  make_folder(folder);
  const PinholeCamera camera = simulated_board_camera();
  const auto rays = sample_rays(camera);
  Random random(1);
  for (int i = 0; i < count; ++i) {
    const SE3 pose = board_pose(random);
    write_png(folder / fmt::format("{:02}.png", i), draw_board(camera, rays, pose, random));
  }
}

}  // namespace kinloop
