#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "apps/reproduce/chapters.hpp"
#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/geometry/camera.hpp"

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

/// A camera like the colour camera of a Kinect 2, at half its size.
PinholeCamera simulated_board_camera() {
  PinholeCamera camera;
  camera.width = 960, camera.height = 540;
  camera.fx = 532, camera.fy = 533.5, camera.cx = 491.5, camera.cy = 265;
  camera.lens.k1 = 0.03, camera.lens.k2 = 0.02, camera.lens.p1 = 0.0005, camera.lens.p2 = -0.002;
  return camera;
}

/// Draws `count` stills of a board of 5 x 7 inner corners and squares of 3 cm, 00.png and so on, tilted to
/// every side.
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

constexpr int kDrawnStills = 25;

/// A table of the parameters of a camera, with the truth where it is known.
MarkdownTable parameter_table(const std::string& camera, const nlohmann::json& parameters,
                              const std::map<std::string, double>& truth) {
  MarkdownTable table{{camera, "estimate", "standard deviation"}};
  if (!truth.empty()) table[0].emplace_back("truth");
  for (const char* name : {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"}) {
    if (!parameters.contains(name)) continue;
    const auto& parameter = parameters[name];
    const int digits = name[0] == 'f' || name[0] == 'c' ? 2 : 5;
    const auto text = [&](double value) { return fmt::format("{:.{}f}", value, digits); };
    table.push_back({name, text(parameter["value"]), text(parameter["deviation"])});
    if (truth.contains(name)) table.back().push_back(text(truth.at(name)));
  }
  return table;
}

nlohmann::json calibrate(Chapter& chapter, const ReproduceFolder& folder, const std::string& what,
                         const std::vector<std::string>& words, const std::string& name) {
  std::vector<std::string> line{"calibrate", what};
  line.insert(line.end(), words.begin(), words.end());
  line.insert(line.end(), {"--board", folder.arguments.board, "--square",
                           fmt::format("{}", folder.arguments.square_m), "-o", folder.at(name + ".yaml")});
  run_program(chapter, line);
  chapter.links.emplace_back("Report of " + name, name + ".html");
  return nlohmann::json::parse(read_file(folder.at(name + ".json")));
}

void calibrate_drawn_stills(Chapter& chapter, const ReproduceFolder& folder) {
  chapter.text = fmt::format(
      "The paper calibrates a Kinect 2 with chessboards. Here {} stills of a board are drawn as a known "
      "camera "
      "sees them; pass real ones with --stills.",
      kDrawnStills);
  const std::string stills = folder.at("stills");
  draw_board_stills(stills, kDrawnStills);
  const PinholeCamera truth = simulated_board_camera();
  chapter.figures["drawn"] = calibrate(chapter, folder, "intrinsics", {stills}, "drawn_camera");
  chapter.tables.push_back(parameter_table("drawn camera", chapter.figures["drawn"]["parameters"],
                                           {{"fx", truth.fx},
                                            {"fy", truth.fy},
                                            {"cx", truth.cx},
                                            {"cy", truth.cy},
                                            {"k1", truth.lens.k1},
                                            {"k2", truth.lens.k2},
                                            {"p1", truth.lens.p1},
                                            {"p2", truth.lens.p2},
                                            {"k3", truth.lens.k3}}));
  chapter.pictures.emplace_back("A drawn still", "stills/00.png");
}

/// The transform between the cameras, from the pairs.
void calibrate_pairs(Chapter& chapter, const ReproduceFolder& folder, const std::filesystem::path& stills) {
  const auto rig = calibrate(chapter, folder, "extrinsics",
                             {(stills / "sync").string(), "--color", (stills / "colour").string(),
                              "--infrared", (stills / "ir").string()},
                             "camera");
  chapter.figures["rig"] = rig;
  MarkdownTable table{{"infrared in colour, mm", "estimate", "standard deviation"}};
  const auto& transform = rig["T_color_infrared"];
  for (size_t i = 0; i < 3; ++i) {
    table.push_back({std::string(1, "xyz"[i]),
                     fmt::format("{:.2f}", 1000 * transform["translation"][i].get<double>()),
                     fmt::format("{:.2f}", 1000 * transform["deviations"][i].get<double>())});
  }
  chapter.tables.push_back(table);
}

}  // namespace

Chapter calibration_chapter(const ReproduceFolder& folder) {
  Chapter chapter;
  chapter.title = "Calibration";
  const std::filesystem::path stills = folder.arguments.stills;
  if (stills.empty()) {
    calibrate_drawn_stills(chapter, folder);
    return chapter;
  }
  chapter.text =
      "The paper calibrates a Kinect 2 with chessboards: each camera alone, then the transform between them.";
  const bool folders = std::filesystem::is_directory(stills / "colour");
  const std::string color = (folders ? stills / "colour" : stills).string();
  chapter.figures["colour"] = calibrate(chapter, folder, "intrinsics", {color}, "colour");
  chapter.tables.push_back(parameter_table("colour", chapter.figures["colour"]["parameters"], {}));
  if (folders && std::filesystem::is_directory(stills / "ir")) {
    chapter.figures["infrared"] =
        calibrate(chapter, folder, "intrinsics", {(stills / "ir").string()}, "infrared");
    chapter.tables.push_back(parameter_table("infrared", chapter.figures["infrared"]["parameters"], {}));
    if (std::filesystem::is_directory(stills / "sync")) calibrate_pairs(chapter, folder, stills);
  }
  return chapter;
}

}  // namespace kinloop
