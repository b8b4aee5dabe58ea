#include "tests/drivers/layout_writers.hpp"

#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <libdeflate.h>
#include <opencv2/imgcodecs.hpp>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time.hpp"
#include "tests/drivers/depth_file_samples.hpp"
#include "tests/drivers/test_video.hpp"

namespace kinloop::test {
namespace {

namespace fs = std::filesystem;

std::string png(const cv::Mat& image) {
  std::vector<uint8_t> bytes;
  cv::imencode(".png", image, bytes);
  return {bytes.begin(), bytes.end()};
}

void put(const fs::path& file, const std::string& content) {
  fs::create_directories(file.parent_path());
  write_file(file, content);
}

/// The content counts: a PNG may be called .jpg, which keeps it lossless.
void put_images(const Sample& s, const std::function<fs::path(size_t)>& color,
                const std::function<fs::path(size_t)>& depth) {
  for (size_t i = 0; i < s.size(); ++i) {
    put(color(i), png(s.colors[i]));
    put(depth(i), png(s.depths_mm[i]));
  }
}

std::string rows_of(const Eigen::Matrix4d& m, int rows = 4, const char* between = " ") {
  std::vector<std::string> numbers;
  for (int i = 0; i < 4 * rows; ++i) numbers.push_back(fmt::format("{:.17g}", m(i / 4, i % 4)));
  return fmt::format("{}", fmt::join(numbers, between));
}

std::string pose_numbers(const SE3& T, const char* between = " ") {
  const auto& t = T.translation;
  const auto& q = T.rotation;
  const std::vector<double> v = {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
  return fmt::format("{}", fmt::join(v, between));
}

Eigen::Matrix4d lens_matrix(const PinholeCamera& lens) {
  Eigen::Matrix4d k = Eigen::Matrix4d::Identity();
  k(0, 0) = lens.fx, k(1, 1) = lens.fy, k(0, 2) = lens.cx, k(1, 2) = lens.cy;
  return k;
}

std::string matrix3_text(const PinholeCamera& l, const char* between) {
  const std::vector<double> k = {l.fx, 0, l.cx, 0, l.fy, l.cy, 0, 0, 1};
  return fmt::format("{}", fmt::join(k, between));
}

/// ARKit's camera: y up, looking along -z.
SE3 in_arkit(const SE3& T) {
  return T * SE3{Eigen::Quaterniond(0, 1, 0, 0), Eigen::Vector3d::Zero()};
}

void write_lists(const fs::path& folder, const Sample& s, const char* color_list, const char* depth_list,
                 const std::string& depth_folder = "depth") {
  std::string rgb = "# t f\n", depth = rgb, truth = rgb;
  for (size_t i = 0; i < s.size(); ++i) {
    rgb += fmt::format("{} rgb/{}.png\n", s.stamp(i), i);
    depth += fmt::format("{} {}/{}.png\n", s.stamp(i), depth_folder, i);
    truth += fmt::format("{} {}\n", s.stamp(i), pose_numbers(s.truth[i].T_world_camera));
  }
  put_images(
      s, [&](size_t i) { return folder / fmt::format("rgb/{}.png", i); },
      [&](size_t i) { return folder / fmt::format("{}/{}.png", depth_folder, i); });
  put(folder / color_list, rgb);
  put(folder / depth_list, depth);
  put(folder / "groundtruth.txt", truth);
}

void write_tum(const fs::path& folder, const Sample& s) {
  write_lists(folder, s, "rgb.txt", "depth.txt");
}

void write_eth3d(const fs::path& folder, const Sample& s) {
  write_tum(folder, s);
  put(folder / "calibration.txt", fmt::format("{} {} {} {}\n", s.lens.fx, s.lens.fy, s.lens.cx, s.lens.cy));
}

void write_icl(const fs::path& folder, const Sample& s) {
  std::string list, truth;
  for (size_t i = 0; i < s.size(); ++i) {
    list += fmt::format("{0} depth/{0}.png {0} rgb/{0}.png\n", i);
    const SE3& T = s.truth[i].T_world_camera;
    const SE3 left_handed{
        Eigen::Quaterniond(T.rotation.w(), -T.rotation.x(), T.rotation.y(), -T.rotation.z()),
        {T.translation.x(), -T.translation.y(), T.translation.z()}};
    truth += fmt::format("{} {}\n", i, pose_numbers(left_handed));
  }
  put_images(
      s, [&](size_t i) { return folder / fmt::format("rgb/{}.png", i); },
      [&](size_t i) { return folder / fmt::format("depth/{}.png", i); });
  put(folder / "associations.txt", list);
  put(folder / "livingRoom0.gt.freiburg", truth);
}

void write_open_loris(const fs::path& folder, const Sample& s) {
  write_lists(folder, s, "color.txt", "aligned_depth.txt", "aligned_depth");
  const auto& l = s.lens;
  put(folder / "sensors.yaml",
      fmt::format(
          "%YAML:1.0\n---\nd400_color_optical_frame:\n   width: {}\n   height: {}\n   intrinsics: "
          "!!opencv-matrix\n      rows: 1\n      cols: 4\n      dt: d\n      data: [ {}, {}, {}, {} ]\n",
          l.width, l.height, l.fx, l.cx, l.fy, l.cy));
  put(folder / "trans_matrix.yaml",
      fmt::format("%YAML:1.0\n---\ntrans_matrix:\n   - parent_frame: base_link\n     child_frame: "
                  "d400_color_optical_frame\n     matrix: !!opencv-matrix\n        rows: 4\n        cols: 4\n"
                  "        dt: d\n        data: [ {} ]\n",
                  rows_of(Eigen::Matrix4d::Identity(), 4, ", ")));
}

void write_frame_files(const fs::path& folder, const Sample& s) {
  const auto name = [&](size_t i, const char* end) {
    return folder / fmt::format("frame-{:06d}.{}", i, end);
  };
  put_images(
      s, [&](size_t i) { return name(i, "color.png"); }, [&](size_t i) { return name(i, "depth.png"); });
  for (size_t i = 0; i < s.size(); ++i) put(name(i, "pose.txt"), rows_of(s.truth[i].T_world_camera.matrix()));
}

void write_seven_scenes(const fs::path& folder, const Sample& s) {
  write_frame_files(folder, s);
  put(folder / "camera-intrinsics.txt", matrix3_text(s.lens, " "));
}

void write_bundle_fusion(const fs::path& folder, const Sample& s) {
  write_frame_files(folder, s);
  for (size_t i = 0; i < s.size(); ++i) {
    fs::remove(folder / fmt::format("frame-{:06d}.depth.png", i));
    put(folder / fmt::format("frame-{:06d}.depth.pgm", i), pgm(s.depths_mm[i]));
  }
  const std::string k = rows_of(lens_matrix(s.lens)), identity = rows_of(Eigen::Matrix4d::Identity());
  put(folder / "info.txt",
      fmt::format("m_versionNumber = 4\nm_colorWidth = {0}\nm_colorHeight = {1}\nm_depthWidth = {0}\n"
                  "m_depthHeight = {1}\nm_depthShift = 1000\nm_calibrationColorIntrinsic = {2}\n"
                  "m_calibrationColorExtrinsic = {3}\nm_calibrationDepthIntrinsic = {2}\n"
                  "m_calibrationDepthExtrinsic = {3}\n",
                  s.lens.width, s.lens.height, k, identity));
}

void write_scannet(const fs::path& folder, const Sample& s) {
  put_images(
      s, [&](size_t i) { return folder / fmt::format("color/{}.jpg", i); },
      [&](size_t i) { return folder / fmt::format("depth/{}.png", i); });
  for (size_t i = 0; i < s.size(); ++i)
    put(folder / fmt::format("pose/{}.txt", i), rows_of(s.truth[i].T_world_camera.matrix()));
  for (const char* camera : {"color", "depth"}) {
    put(folder / fmt::format("intrinsic/intrinsic_{}.txt", camera), rows_of(lens_matrix(s.lens)));
    put(folder / fmt::format("intrinsic/extrinsic_{}.txt", camera), rows_of(Eigen::Matrix4d::Identity()));
  }
}

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void append_matrix(std::string& bytes, const Eigen::Matrix4d& m) {
  for (int i = 0; i < 16; ++i) append(bytes, static_cast<float>(m(i / 4, i % 4)));
}

std::string deflated(const cv::Mat& image) {
  constexpr int kLevel = 6;
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(kLevel);
  const size_t size = image.total() * image.elemSize();
  std::string bytes(libdeflate_zlib_compress_bound(compressor, size), '\0');
  bytes.resize(libdeflate_zlib_compress(compressor, image.data, size, bytes.data(), bytes.size()));
  libdeflate_free_compressor(compressor);
  return bytes;
}

void write_sens(const fs::path& folder, const Sample& s) {
  constexpr int32_t kPng = 1, kZlib = 1;
  const std::string name = "test";
  std::string bytes;
  append(bytes, uint32_t{4});
  append(bytes, static_cast<uint64_t>(name.size()));
  bytes += name;
  for (int camera = 0; camera < 2; ++camera) {
    append_matrix(bytes, lens_matrix(s.lens));
    append_matrix(bytes, Eigen::Matrix4d::Identity());
  }
  append(bytes, kPng);
  append(bytes, kZlib);
  for (int camera = 0; camera < 2; ++camera) {
    append(bytes, static_cast<uint32_t>(s.lens.width));
    append(bytes, static_cast<uint32_t>(s.lens.height));
  }
  append(bytes, 1000.0F);
  append(bytes, static_cast<uint64_t>(s.size()));
  for (size_t i = 0; i < s.size(); ++i) {
    const std::string color = png(s.colors[i]), depth = deflated(s.depths_mm[i]);
    append_matrix(bytes, s.truth[i].T_world_camera.matrix());
    for (int stamp = 0; stamp < 2; ++stamp) append(bytes, uint64_t{0});  // as older recorders did
    append(bytes, static_cast<uint64_t>(color.size()));
    append(bytes, static_cast<uint64_t>(depth.size()));
    bytes += color + depth;
  }
  put(folder / "scene0000_00.sens", bytes);
}

void write_replica(const fs::path& folder, const Sample& s) {
  put_images(
      s, [&](size_t i) { return folder / fmt::format("results/frame{:06d}.jpg", i); },
      [&](size_t i) { return folder / fmt::format("results/depth{:06d}.png", i); });
  std::string poses;
  for (const StampedPose& pose : s.truth) poses += rows_of(pose.T_world_camera.matrix()) + "\n";
  put(folder / "traj.txt", poses);
  const auto& l = s.lens;
  put(folder / "cam_params.json",
      fmt::format(
          R"({{"camera": {{"w": {}, "h": {}, "fx": {}, "fy": {}, "cx": {}, "cy": {}, "scale": 1000}}}})",
          l.width, l.height, l.fx, l.fy, l.cx, l.cy));
}

/// Depth in metres, as a reader of millimetres gets it.
cv::Mat metres(const cv::Mat& depth_mm) {
  cv::Mat depth_m;
  depth_mm.convertTo(depth_m, CV_32FC1, 1.0 / 1000);
  return depth_m;
}

std::string raw(const cv::Mat& image) {
  return {reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()};
}

void write_tartan_air(const fs::path& folder, const Sample& s) {
  Eigen::Matrix3d R_camera_ned;  // x forward, y right, z down
  R_camera_ned << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  std::string poses;
  for (size_t i = 0; i < s.size(); ++i) {
    put(folder / fmt::format("image_left/{:06d}_left.png", i), png(s.colors[i]));
    put(folder / fmt::format("depth_left/{:06d}_left_depth.npy", i), numpy(metres(s.depths_mm[i])));
    const SE3 T_camera_ned{Eigen::Quaterniond(R_camera_ned), Eigen::Vector3d::Zero()};
    poses += pose_numbers(s.truth[i].T_world_camera * T_camera_ned) + "\n";
  }
  put(folder / "pose_left.txt", poses);
}

void write_stray_scanner(const fs::path& folder, const Sample& s) {
  std::string odometry = "timestamp, frame, x, y, z, qx, qy, qz, qw\n";
  for (size_t i = 0; i < s.size(); ++i) {
    put(folder / fmt::format("depth/{:06d}.png", i), png(s.depths_mm[i]));
    put(folder / fmt::format("confidence/{:06d}.png", i),
        png(cv::Mat(s.depths_mm[i].size(), CV_8UC1, cv::Scalar(2))));
    odometry += fmt::format("{}, {:06d}, {}\n", s.stamp(i), i, pose_numbers(s.truth[i].T_world_camera, ", "));
  }
  put(folder / "odometry.csv", odometry);
  put(folder / "camera_matrix.csv", matrix3_text(s.lens, ", "));
  write_lossless_video(folder / "rgb.mp4", s.colors);
}

void write_scanner_3d_app(const fs::path& folder, const Sample& s) {
  put_images(
      s, [&](size_t i) { return folder / fmt::format("frame_{:05d}.jpg", i); },
      [&](size_t i) { return folder / fmt::format("depth_{:05d}.png", i); });
  for (size_t i = 0; i < s.size(); ++i) {
    put(folder / fmt::format("conf_{:05d}.png", i),
        png(cv::Mat(s.depths_mm[i].size(), CV_8UC1, cv::Scalar(1))));
    put(folder / fmt::format("frame_{:05d}.json", i),
        fmt::format(R"({{"time": {}, "intrinsics": [{}], "cameraPoseARFrame": [{}]}})", s.stamp(i),
                    matrix3_text(s.lens, ", "),
                    rows_of(in_arkit(s.truth[i].T_world_camera).matrix(), 4, ", ")));
  }
}

void write_polycam(const fs::path& folder, const Sample& s) {
  const auto name = [&](const char* kind, size_t i, const char* end) {
    return folder / "keyframes" / kind / fmt::format("{}{}", s.truth[i].stamp_ns / 1000, end);
  };
  put_images(
      s, [&](size_t i) { return name("images", i, ".jpg"); },
      [&](size_t i) { return name("depth", i, ".png"); });
  for (size_t i = 0; i < s.size(); ++i) {
    const Eigen::Matrix4d T = in_arkit(s.truth[i].T_world_camera).matrix();
    std::string json = fmt::format(
        R"({{"width": {}, "height": {}, "fx": {}, "fy": {}, "cx": {}, "cy": {}, "timestamp": {:.3f})",
        s.lens.width, s.lens.height, s.lens.fx, s.lens.fy, s.lens.cx, s.lens.cy,
        1e-3 * static_cast<double>(s.truth[i].stamp_ns));
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column)
        json += fmt::format(R"(, "t_{}{}": {:.17g})", row, column, T(row, column));
    }
    put(name("cameras", i, ".json"), json + "}");
  }
}

void write_record3d(const fs::path& folder, const Sample& s) {
  std::vector<std::string> poses, times;
  for (size_t i = 0; i < s.size(); ++i) {
    put(folder / fmt::format("rgbd/{}.jpg", i), png(s.colors[i]));
    put(folder / fmt::format("rgbd/{}.depth", i), raw(metres(s.depths_mm[i])));
    const SE3 T = in_arkit(s.truth[i].T_world_camera);
    const auto& q = T.rotation;
    const auto& t = T.translation;
    poses.push_back(
        fmt::format("[{}, {}, {}, {}, {}, {}, {}]", q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()));
    times.push_back(s.stamp(i));
  }
  const auto& l = s.lens;
  put(folder / "metadata",
      fmt::format(
          R"({{"w": {0}, "h": {1}, "dw": {0}, "dh": {1}, "fps": 30, "K": [{2}, 0, 0, 0, {3}, 0, {4}, {5}, 1],)"
          R"( "poses": [{6}], "frameTimestamps": [{7}]}})",
          l.width, l.height, l.fx, l.fy, l.cx, l.cy, fmt::join(poses, ", "), fmt::join(times, ", ")));
}

void write_record3d_export(const fs::path& folder, const Sample& s) {
  std::vector<std::string> poses;
  for (size_t i = 0; i < s.size(); ++i) {
    put(folder / fmt::format("rgb/{}.jpg", i), png(s.colors[i]));
    put(folder / fmt::format("depth/{}.exr", i), exr(metres(s.depths_mm[i])));
    put(folder / fmt::format("confidence/{}.png", i),
        png(cv::Mat(s.depths_mm[i].size(), CV_8UC1, cv::Scalar(2))));
    const SE3 T = in_arkit(s.truth[i].T_world_camera);
    const auto& q = T.rotation;
    const auto& t = T.translation;
    poses.push_back(
        fmt::format("[{}, {}, {}, {}, {}, {}, {}]", q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()));
  }
  const auto& l = s.lens;
  put(folder / "metadata.json",
      fmt::format(R"({{"w": {}, "h": {}, "fps": 30, "K": [{}, 0, 0, 0, {}, 0, {}, {}, 1], "poses": [{}]}})",
                  l.width, l.height, l.fx, l.fy, l.cx, l.cy, fmt::join(poses, ", ")));
}

/// As SplaTAM writes captures of NeRFCapture.
void write_transforms(const fs::path& folder, const Sample& s) {
  put_images(
      s, [&](size_t i) { return folder / fmt::format("rgb/{}.png", i); },
      [&](size_t i) { return folder / fmt::format("depth/{}.png", i); });
  std::vector<std::string> frames;
  for (size_t i = 0; i < s.size(); ++i) {
    std::vector<std::string> rows;
    const Eigen::Matrix4d T = in_arkit(s.truth[i].T_world_camera).matrix();
    for (int row = 0; row < 4; ++row)
      rows.push_back(
          fmt::format("[{:.17g}, {:.17g}, {:.17g}, {:.17g}]", T(row, 0), T(row, 1), T(row, 2), T(row, 3)));
    frames.push_back(fmt::format(
        R"({{"file_path": "rgb/{0}.png", "depth_path": "depth/{0}.png", "transform_matrix": [{1}]}})", i,
        fmt::join(rows, ", ")));
  }
  const auto& l = s.lens;
  put(folder / "transforms.json",
      fmt::format(
          R"({{"w": {}, "h": {}, "fl_x": {}, "fl_y": {}, "cx": {}, "cy": {}, "integer_depth_scale": 0.001,)"
          R"( "frames": [{}]}})",
          l.width, l.height, l.fx, l.fy, l.cx + 0.5, l.cy + 0.5, fmt::join(frames, ", ")));
}

void write_folders(const fs::path& folder, const Sample& s) {
  put_images(
      s, [&](size_t i) { return folder / fmt::format("color/{}.png", i); },
      [&](size_t i) { return folder / fmt::format("depth/{}.png", i); });
}

void write_side_by_side(const fs::path& folder, const Sample& s) {
  put_images(
      s, [&](size_t i) { return folder / fmt::format("{}_color.png", i); },
      [&](size_t i) { return folder / fmt::format("{}_depth.png", i); });
}

void write_redwood(const fs::path& folder, const Sample& s) {
  write_folders(folder, s);
  const auto& l = s.lens;
  put(folder / "camera_intrinsic.json",
      fmt::format(R"({{"width": {}, "height": {}, "intrinsic_matrix": [{}, 0, 0, 0, {}, 0, {}, {}, 1]}})",
                  l.width, l.height, l.fx, l.fy, l.cx, l.cy));
  std::string log;
  for (size_t i = 0; i < s.size(); ++i)
    log += fmt::format("{} {} {}\n{}\n", i, i, i + 1, rows_of(s.truth[i].T_world_camera.matrix()));
  put(folder / "trajectory.log", log);
}

}  // namespace

std::string Sample::stamp(size_t i) const {
  return format_stamp(truth[i].stamp_ns);
}

Sample make_sample(int frames, cv::Size size) {
  Sample s;
  s.lens.width = size.width, s.lens.height = size.height;
  s.lens.fx = s.lens.fy = 0.75 * size.width;
  s.lens.cx = 0.5 * (size.width - 1), s.lens.cy = 0.5 * (size.height - 1);
  cv::RNG random(7);
  for (int i = 0; i < frames; ++i) {
    cv::Mat color(size, CV_8UC3), depth(size, CV_16UC1);
    random.fill(color, cv::RNG::UNIFORM, 0, 256);
    random.fill(depth, cv::RNG::UNIFORM, 500, 4000);
    depth.at<uint16_t>(0, 0) = 0;
    s.colors.push_back(color);
    s.depths_mm.push_back(depth);
    s.truth.push_back(
        {to_ns(i / 30.0), {exp_so3({0.01 * i, -0.02 * i, 0.03 * i}), {0.1 * i, 0.2, -0.05 * i}}});
  }
  return s;
}

const std::vector<LayoutWriter>& layout_writers() {
  static const std::vector<LayoutWriter> kWriters = {
      {"TUM", true, write_tum},
      {"ETH3D", true, write_eth3d},  // depth in 1/5000 m
      {"ICL-NUIM", true, write_icl},
      {"OpenLORIS", false, write_open_loris},
      {"7-Scenes", false, write_seven_scenes},
      {"BundleFusion", false, write_bundle_fusion},
      {"ScanNet", false, write_scannet},
      {"ScanNet recording", false, write_sens},
      {"Replica", false, write_replica},
      {"TartanAir", true, write_tartan_air},
#ifdef KINLOOP_WITH_VIDEO
      {"Stray Scanner", false, write_stray_scanner},
#endif
      {"3D Scanner App", false, write_scanner_3d_app},
      {"Polycam", false, write_polycam},
      {"Record3D", false, write_record3d},
      {"Record3D export", false, write_record3d_export},
      {"Nerfstudio, NeRFCapture", false, write_transforms},
      {"Redwood or Open3D", false, write_redwood},
      {"colour and depth images", true, write_folders},
      {"images side by side", true, write_side_by_side},
  };
  return kWriters;
}

}  // namespace kinloop::test
