#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/image_files/image_file.hpp"
#include "tests/apps/mistakes.hpp"

namespace kinloop::test {
namespace {

namespace fs = std::filesystem;

/// A camera.yaml with `fx` as the focal length.
std::string camera_with(const std::string& fx) {
  return fmt::format(
      "width: 160\nheight: 120\nfx: {}\nfy: 131\ncx: 79.5\ncy: 59.5\ndistortion: [0, 0, 0, 0, 0]\n"
      "depth_scale: 5000\nfps: 30\n",
      fx);
}

/// A copy of the sequence with its lists but without associations.txt.
fs::path copy_of_sequence(const TempFolder& folder, const char* name) {
  fs::copy(folder.path() / "seq", folder.path() / name, fs::copy_options::recursive);
  fs::remove(folder.path() / name / "associations.txt");
  return folder.path() / name;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

void write_depth(const fs::path& sequence, const cv::Mat& image) {
  for (const auto& entry : fs::directory_iterator(sequence / "depth")) write_png(entry.path(), image);
}

void make_broken_sequences(const TempFolder& folder) {
  fs::remove(copy_of_sequence(folder, "no_camera") / "camera.yaml");
  const fs::path only_rgb = copy_of_sequence(folder, "only_rgb");
  for (const char* name : {"depth.txt", "camera.yaml"}) fs::remove(only_rgb / name);
  const fs::path no_lists = copy_of_sequence(folder, "no_lists");
  for (const char* name : {"rgb.txt", "depth.txt"}) fs::remove(no_lists / name);
  copy_of_sequence(folder, "wrong_names");
  const std::string rgb = read_file(folder.path() / "seq/rgb.txt");
  folder.write("wrong_names/rgb.txt", replaced(rgb, "rgb/", "color/"));
  copy_of_sequence(folder, "empty_list");
  folder.write("empty_list/depth.txt", "# timestamp filename\n");
  copy_of_sequence(folder, "one_column");
  folder.write("one_column/rgb.txt", "0.png\n1.png\n");
  copy_of_sequence(folder, "apart");
  folder.write("apart/rgb.txt", replaced(rgb, "\n1", "\n91"));
  write_depth(copy_of_sequence(folder, "depth8"), cv::Mat(120, 160, CV_8UC1, cv::Scalar(100)));
  write_depth(copy_of_sequence(folder, "depth_size"), cv::Mat(50, 80, CV_16UC1, cv::Scalar(5000)));
  copy_of_sequence(folder, "bad_truth");
  folder.write("bad_truth/groundtruth.txt", "1.0 0 wide 0 0 0 0 1\n");
}

/// Folders in the layouts of other datasets; only names matter.
void make_foreign_folders(const TempFolder& folder) {
  for (const char* file : {"7scenes/frame-000000.color.png",
                           "7scenes/frame-000000.depth.png",
                           "scannet/color/0.jpg",
                           "scannet/depth/0.png",
                           "scannet/pose/0.txt",
                           "scannet/intrinsic/intrinsic_color.txt",
                           "sens/scene0000_00.sens",
                           "redwood/color/0.jpg",
                           "redwood/depth/0.png",
                           "redwood/intrinsic.json",
                           "replica/results/frame000000.jpg",
                           "replica/traj.txt",
                           "icl/scene_00_0000.depth",
                           "icl/scene_00_0000.png",
                           "euroc/mav0/cam0/data.csv",
                           "kitti/image_2/000000.png",
                           "kitti/calib.txt",
                           "ros2/metadata.yaml",
                           "ros2/take_0.db3",
                           "video.mp4"}) {
    folder.write(file, "x");
  }
  fs::create_directories(folder.path() / "empty");
  fs::create_directories(folder.path() / "images");
  write_png(folder.path() / "images/0.png", cv::Mat(120, 160, CV_8UC3, cv::Scalar(90, 120, 150)));
}

void make_files(const TempFolder& folder) {
  folder.write("no_fx.yaml", replaced(camera_with("131"), "fx: 131\n", ""));
  folder.write("unknown.yaml", camera_with("131") + "focal: 131\n");
  folder.write("text.yaml", camera_with("wide"));
  folder.write("range.yaml", camera_with("5"));
  folder.write("odd.txt", "1 0 0 0 0\n");
  folder.write("kitti.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  folder.write("late.txt", "9000 0 0 0 0 0 0 1\n9001 1 0 0 0 0 0 1\n9002 0 1 0 0 0 0 1\n");
  const std::string map = read_file(folder.path() / "out/map.kinmap");
  folder.write("cut.kinmap", map.substr(0, map.size() / 8));
}

}  // namespace

void make_mistake_folder(const TempFolder& folder) {
  const std::string there = "cd '" + folder.path().string() + "';";
  for (const char* arguments : {"simulate room --frames 4 --size 160x120 -q -o seq", "run seq -q -o out"}) {
    const ProgramRun run = run_program(folder, arguments, there);
    if (run.exit_code != kDone) throw std::runtime_error(run.err);
  }
  fs::create_directories(folder.path() / "parent");
  for (const char* inner : {"parent/first", "parent/second"})
    fs::create_directory_symlink(folder.path() / "seq", folder.path() / inner);
  make_broken_sequences(folder);
  make_foreign_folders(folder);
  make_files(folder);
}

}  // namespace kinloop::test
