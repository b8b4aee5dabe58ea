// Writes the seeds of the fuzz targets into tests/fuzz/corpus: make_fuzz_seeds FOLDER. Most are made by the
// writers of the library and its tests; text that is short is given here.

#include <cstdio>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "dense/files/mesh_file.hpp"
#include "dense/files/pcd.hpp"
#include "dense/files/ply.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/place/vocabulary/vocabulary_file.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "kinloop/sensor/images/depth_codec.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "tests/drivers/archive_writer.hpp"
#include "tests/drivers/bag_writers.hpp"
#include "tests/drivers/camera_file_samples.hpp"
#include "tests/drivers/depth_file_samples.hpp"
#include "tests/drivers/layout_writers.hpp"
#include "tests/drivers/mkv_writer.hpp"
#include "tests/drivers/oni_writer.hpp"
#include "tests/drivers/ros1_bag_writer.hpp"
#include "tests/fuzz/targets/map_rows.hpp"
#include "tests/place/synthetic.hpp"
#include "tests/support/synthetic_map.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/vocabulary_training/dbow2_text.hpp"
#include "tools/vocabulary_training/descriptors/descriptor_file.hpp"
#include "tools/vocabulary_training/trainer.hpp"

namespace kinloop::fuzz {
namespace {

namespace fs = std::filesystem;
using test::Serialization;

const cv::Size kSmall(8, 6);

class Corpus {
 public:
  explicit Corpus(fs::path folder) : folder_(std::move(folder)) {}

  void add(const std::string& target, const std::string& name, std::string_view bytes) const {
    fs::create_directories(folder_ / target);
    write_file(folder_ / target / name, bytes);
  }

  /// Adds the files of a folder as an archive.
  void add_folder(const std::string& target, const std::string& name, const fs::path& files) const {
    std::vector<fs::path> paths;
    for (const auto& entry : fs::recursive_directory_iterator(files)) {
      if (entry.is_regular_file()) paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end());
    std::string archive;
    for (const fs::path& path : paths)
      archive += fmt::format("-- {} --\n{}\n", fs::relative(path, files).string(), read_file(path));
    add(target, name, archive);
  }

 private:
  fs::path folder_;
};

template <class Write>
std::string written(const std::string& name, const Write& write) {
  const test::TempFolder folder;
  write(folder.path() / name);
  return read_file(folder.path() / name);
}

PinholeCamera small_lens() {
  PinholeCamera lens;
  lens.width = kSmall.width, lens.height = kSmall.height;
  lens.fx = lens.fy = 7, lens.cx = 3.5, lens.cy = 2.5;
  return lens;
}

std::string color_png(int type = CV_8UC3) {
  return test::encoded(test::make_color(1, type, kSmall), ".png");
}

std::string depth_png() {
  return test::encoded(test::make_depth(1000, kSmall), ".png");
}

void add_text(const Corpus& corpus) {
  corpus.add("g2o", "3d",
             "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0 1\nFIX 0\n"
             "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n");
  corpus.add("g2o", "2d",
             "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0.5\nEDGE_SE2 0 1 1 0 0.5 1 0 0 1 0 1\n"
             "EDGE_PRIOR_SE2 0 0 0 0 1 0 0 1 0 1\n");
  corpus.add("g2o", "edges", "EDGE_SE2 0 1 1 0 0.5 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0.5 1 2 0 1 0 1\n");
  corpus.add("g2o", "offset",
             "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"
             "EDGE_SE3_PRIOR 0 0 0 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n");
  using test::tar_member;
  corpus.add("archive", "tar",
             tar_member("room/rgb.txt", "1 a.png\n") + tar_member("room/rgb", "", '5') +
                 tar_member("../out", "x") + test::tar_end());
  corpus.add("archive", "tar_links",
             tar_member("a", "x") + tar_member("hard", "", '1', "a") + tar_member("soft", "", '2', "..") +
                 test::tar_end());
  corpus.add("trajectory", "four",
             "# stamp x y z qx qy qz qw\n1.5 0 0 0 0 0 0 1\n2.5 1 0 0 0 0 0.1 1\n3.5 1 1 0.5 0 0 0 1\n"
             "4 0 1 2 0 0.5 0 0.5\n");
  corpus.add("options", "some", "seed=3\ndense.voxel_m=0.02\nexecutor.mode=live\nglobal_ba_enabled=false\n");
  corpus.add("options", "renamed", "dense.patch_memory_mib=32\nviewer.max_m=3\nfeatures.kind=sift\n");
  corpus.add("frame_lists", "associations", "-- associations.txt --\n1.0 rgb/1.png 1.01 depth/1.png\n");
  corpus.add(
      "frame_lists", "two",
      "-- rgb.txt --\n# colour\n1.0 rgb/1.png\n1.1 rgb/2.png\n-- depth.txt --\n1.0 d/1.png\n1.1 d/2.png\n");
}

void add_cameras(const Corpus& corpus) {
  RgbdCamera camera;
  camera.color = small_lens();
  const auto text_of = [&] {
    return written("camera.yaml", [&](const fs::path& p) { write_camera_file(p, camera); });
  };
  corpus.add("camera", "plain", text_of());
  camera.color.lens = {LensModel::kRational, 1, 2, 0.1, 0.2, 3, 4, 5, 6};
  camera.depth = small_lens();
  camera.depth->lens.model = LensModel::kKannalaBrandt;
  camera.T_color_depth = {exp_so3({0, 0.01, 0}), {0.05, 0, 0.002}};
  camera.depth_shift_m = -0.01;
  camera.sensor.set_by_source(DepthSensorModel::kKinect2);
  corpus.add("camera", "two_lenses", text_of());
  std::string format;
  for (const test::CameraFileSample& sample : test::camera_file_samples()) {
    if (sample.format != format) corpus.add("camera", sample.file, sample.text);  // the first of each format
    format = sample.format;
  }
  corpus.add("azure_calibration", "factory", test::kAzureCalibration);
}

void add_images(const Corpus& corpus) {
  corpus.add("png", "color", color_png());
  corpus.add("png", "gray", color_png(CV_8UC1));
  corpus.add("png", "alpha", color_png(CV_8UC4));
  corpus.add("png", "depth", depth_png());
  const cv::Mat color = test::make_color(2, CV_8UC3, {16, 9});
  for (const int type : {CV_8UC3, CV_8UC1}) {
    const auto bytes = encode_jpeg(test::make_color(2, type, {16, 9}), 80);
    corpus.add("jpeg", type == CV_8UC1 ? "gray" : "color",
               {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
  std::vector<uint8_t> progressive;
  cv::imencode(".jpg", color, progressive,
               {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 2});
  corpus.add("jpeg", "progressive", {reinterpret_cast<const char*>(progressive.data()), progressive.size()});
}

/// The encodings of depth_targets.cpp by their numbers, with a size of 8 x 6.
void add_depth(const Corpus& corpus) {
  const std::string size = {7, 5};
  const cv::Mat depth = test::make_depth(1000, kSmall);
  const auto packed = pack_depth({depth.ptr<uint16_t>(), depth.total()});
  corpus.add("depth_codec", "flat", '\0' + size + std::string(packed.begin(), packed.end()));
  corpus.add("depth_codec", "holes", '\0' + size + "\x01\x12\x34\x02\x11\x99");
  const std::string raw(reinterpret_cast<const char*>(depth.data), 2 * depth.total());
  corpus.add("depth_encodings", "rvl", '\0' + size + std::string("\0\0\0\x30\x11\x22\x33\x44", 8));
  corpus.add("depth_encodings", "16z", '\1' + size + std::string("\3\xE8\x66\x66\x6D\xE8\xE8", 7));
  corpus.add("depth_encodings", "16z_table", '\2' + size + std::string("\2\0\0\0\xE8\3\0\1\x66\x66", 10));
  corpus.add("depth_encodings", "png", '\3' + size + depth_png());
  corpus.add("depth_encodings", "pgm", '\3' + size + "P5\n8 6\n65535\n" + raw);
  for (const test::DepthFormat& format : test::depth_formats()) {
    if (!format.writes_numbers) continue;
    std::string name = format.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    corpus.add("depth_encodings", name, '\3' + size + format.write(depth));
  }
  const std::pair<const char*, test::TiffLayout> tiff_layouts[] = {
      {"tiff_tiles", {.compression = 5, .predictor = 2, .tile_px = 16}},
      {"tiff_big_endian", {.mode = "wb"}},
      {"tiff_big", {.compression = 50000, .mode = "w8"}},
      {"tiff_pages", {.kinds_of_pages = {0, 1, 4}}}};
  for (const auto& [name, layout] : tiff_layouts)
    corpus.add("depth_encodings", name, '\3' + size + test::tiff_by_libtiff(depth, layout));
  for (const test::ExrSample& sample : test::exr_samples())
    corpus.add("depth_encodings", std::string("exr_") + sample.compression, '\3' + size + sample.bytes);
  corpus.add("depth_encodings", "raw", '\4' + size + raw);
  corpus.add("depth_encodings", "float", '\6' + size + raw + raw);
  corpus.add("depth_encodings", "numpy",
             '\7' + size + "\x93NUMPY\x01" + std::string("\0\x46\0", 3) +
                 fmt::format("{:<69}\n", "{'descr': '<f4', 'fortran_order': False, 'shape': (6, 8), }") +
                 raw + raw);
}

void add_point_files(const Corpus& corpus) {
  const ColoredCloud cloud{{{0, 0, 1}, {0.5, 0, 1}, {0, 0.5, 1}}, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {}};
  corpus.add("ply", "cloud", written("a.ply", [&](const fs::path& p) { write_ply(p, cloud); }));
  corpus.add("pcd", "cloud", written("a.pcd", [&](const fs::path& p) { write_pcd(p, cloud); }));
  const ColoredMesh mesh{cloud.points, cloud.colors, {{0, 1, 2}}};
  corpus.add("glb", "mesh", written("a.glb", [&](const fs::path& p) { write_mesh(p, mesh); }));
  corpus.add(
      "ply", "ascii_mesh",
      "ply\nformat ascii 1.0\ncomment frame z-up\nelement vertex 4\nproperty float x\nproperty double y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n"
      "0 1 0 1 2 3\n4 0 1 2 3\n");
  corpus.add(
      "ply", "big_endian",
      std::string("ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                  "property float z\nelement face 1\nproperty list uchar ushort vertex_index\nend_header\n") +
          std::string("\x3f\x80\0\0\x3f\x80\0\0\x3f\x80\0\0\3\0\0\0\0\0\0", 19));
  const std::string fields = "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n";
  const std::string size = "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n";
  corpus.add("pcd", "ascii", "VERSION .7\n" + fields + size + "DATA ascii\n0 0 1 255\nnan 1 1 65280\n");
  corpus.add("pcd", "compressed",
             "VERSION .7\n" + fields + size + "DATA binary_compressed\n" +
                 std::string("\x21\0\0\0\x20\0\0\0\x1f", 9) + std::string(32, '\1'));
}

void add_places(const Corpus& corpus) {
  TrainOptions options;
  options.branching = 3, options.depth = 2;
  const Vocabulary vocabulary = train_vocabulary(test::clustered_images(5, 40, 30, 1), options);
  corpus.add("vocabulary", "tree", serialize_vocabulary(vocabulary));
  corpus.add("dbow2", "tree", written("a.txt", [&](const fs::path& p) { write_dbow2(p, vocabulary); }));
  corpus.add("descriptors", "images", written("a.kindesc", [&](const fs::path& p) {
               DescriptorFileWriter writer(p, DescriptorKind::kOrb);
               writer.append(cv::Mat(2, 32, CV_8UC1, cv::Scalar(7)));
               writer.append(cv::Mat());
               writer.append(cv::Mat(1, 32, CV_8UC1, cv::Scalar(8)));
               writer.commit();
             }));
}

void add_map(const Corpus& corpus) {
  test::SyntheticWorld world = test::make_world(60, 3);
  PinholeCamera& camera = world.camera;
  camera.width = 64, camera.height = 48, camera.fx = camera.fy = 52.5, camera.cx = 31.5, camera.cy = 23.5;
  test::SyntheticMap built;
  SavedMap saved;
  for (uint32_t i = 0; i < 3; ++i) {
    const SE3 pose = test::pose_on_arc(static_cast<int>(i));
    add_view(built, world, test::observe(world, pose, {}, i), pose);
    TrackedFrame frame;
    frame.id = FrameId{i};
    frame.stamp_ns = i * 100'000'000LL;
    frame.outcome = TrackingOutcome::kTracked;
    frame.reference = frame.keyframe = KeyframeId{i};
    saved.frames.push_back(frame);
  }
  built.map.add_loop_closure({.a = KeyframeId{0},
                              .b = KeyframeId{2},
                              .T_a_b = test::pose_on_arc(0).inverse() * test::pose_on_arc(2),
                              .stage = LoopStage::kVerified});
  saved.program = "kinloop";
  saved.sessions = {{"room", FrameId{0}}};
  saved.options = {{"seed", "1"}};
  saved.camera.color = camera;
  saved.sensor.resize(3);
  saved.map = built.map.data();
  const auto encoded = encode_images(cv::Mat(48, 64, CV_8UC3, cv::Scalar(1, 2, 3)),
                                     cv::Mat(48, 64, CV_32FC1, cv::Scalar(1.5)), {})
                           .encoded;
  const test::TempFolder folder;
  const fs::path path = folder.path() / "map.kinmap";
  write_map(path, saved, 2, [&](size_t i) {
    return SavedImages{FrameId{static_cast<uint32_t>(i)}, encoded};
  });
  corpus.add("map", "three_keyframes", to_bytes(read_rows(path)));
}

test::WrittenBag ros2_bag(bool compressed) {
  constexpr auto kKind = Serialization::kCdrLittle;
  test::WrittenBag bag = {{"/camera/color/camera_info", "sensor_msgs/msg/CameraInfo", 1,
                           test::info_message(kKind, small_lens())}};
  for (int i = 0; i < 2; ++i) {
    const int64_t stamp = 33'000'000 * (i + 1);
    if (compressed) {
      bag.push_back({"/camera/color/image_raw/compressed", "sensor_msgs/msg/CompressedImage", stamp,
                     test::compressed_message(kKind, stamp, "png", color_png())});
      bag.push_back({"/camera/aligned_depth_to_color/image_raw/compressedDepth",
                     "sensor_msgs/msg/CompressedImage", stamp,
                     test::compressed_message(kKind, stamp, "16UC1; compressedDepth",
                                              std::string(12, '\0') + depth_png())});
      continue;
    }
    bag.push_back({"/camera/color/image_raw", "sensor_msgs/msg/Image", stamp,
                   test::image_message(kKind, stamp, test::make_color(i, CV_8UC3, kSmall), "bgr8")});
    bag.push_back({"/camera/aligned_depth_to_color/image_raw", "sensor_msgs/msg/Image", stamp,
                   test::image_message(kKind, stamp, test::make_depth(1000, kSmall), "16UC1")});
  }
  return bag;
}

void add_ros1_bags(const Corpus& corpus) {
  constexpr auto kKind = Serialization::kRos1;
  test::Ros1BagWriter plain, realsense;
  plain.add("/camera/rgb/camera_info", "sensor_msgs/CameraInfo", 1, test::info_message(kKind, small_lens()));
  const std::string color = "/device_0/sensor_1/Color_0", depth = "/device_0/sensor_0/Depth_0";
  realsense.add(color + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
                test::info_message(kKind, small_lens(), "Inverse Brown Conrady"));
  realsense.add(depth + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
                test::info_message(kKind, small_lens(), "Brown Conrady"));
  for (const std::string& stream : {color, depth})
    realsense.add(stream + "/tf/0", "geometry_msgs/Transform", 1,
                  test::MessageWriter(kKind).transform({exp_so3({0.1, 0, 0}), {0.1, 0.2, 0}}).bytes());
  realsense.add("/device_0/sensor_0/option/Depth Units/value", "std_msgs/Float32", 1,
                test::MessageWriter(kKind).number(0.001F).bytes());
  for (int i = 0; i < 2; ++i) {
    const int64_t stamp = 33'000'000 * (i + 1);
    const auto rgb = test::image_message(kKind, stamp, test::make_color(i, CV_8UC3, kSmall), "rgb8");
    const auto units = test::image_message(kKind, stamp, test::make_depth(1000, kSmall), "mono16");
    plain.add("/camera/rgb/image_color", "sensor_msgs/Image", stamp, rgb);
    plain.add("/camera/depth/image", "sensor_msgs/Image", stamp, units);
    realsense.add(color + "/image/data", "sensor_msgs/Image", stamp, rgb);
    realsense.add(depth + "/image/data", "sensor_msgs/Image", stamp, units);
  }
  corpus.add("ros1_bag", "plain", plain.bytes());
  corpus.add("realsense_bag", "two_streams", realsense.bytes());
}

void add_recordings(const Corpus& corpus) {
  add_ros1_bags(corpus);
  test::McapLayout flat, chunks;
  flat.chunks = flat.summary = false;
  corpus.add("mcap", "flat", test::mcap_bytes(ros2_bag(false), flat));
  corpus.add("mcap", "compressed_images", test::mcap_bytes(ros2_bag(true), flat));
  for (const char* compression : {"lz4", "zstd"}) {
    chunks.compression = compression;
    corpus.add("mcap", compression, test::mcap_bytes(ros2_bag(false), chunks));
  }
  corpus.add("sqlite_bag", "raw",
             written("a.db3", [](const fs::path& p) { test::write_db3(p, ros2_bag(false)); }));
  test::MkvParts mkv;
  mkv.frames = 2, mkv.depth_fourcc = "MPNG";
  mkv.color_size = {16, 9}, mkv.depth_size = {12, 10};  // those of the target's camera
  corpus.add("azure", "mjpg", test::mkv_bytes(mkv));
  test::OniWriterStream depth{1, 2, "NONE", 100, kSmall}, color{2, 3, "NONE", 200, kSmall};
  std::string oni = test::oni_header() + test::oni_stream(depth, 2) + test::oni_stream(color, 2) +
                    test::oni_data_begin(1, 2) + test::oni_data_begin(2, 2);
  for (uint32_t i = 0; i < 2; ++i) {
    oni += test::oni_image(2, 33'333 * (i + 1), i + 1, std::string(3 * 48, '\x55'));
    oni += test::oni_image(1, 33'333 * (i + 1), i + 1, std::string(2 * 48, '\x07'));
  }
  corpus.add("oni", "raw", oni + test::oni_end());
}

void add_layouts(const Corpus& corpus) {
  const test::Sample sample = test::make_sample(3, kSmall);
  for (const test::LayoutWriter& layout : test::layout_writers()) {
    const test::TempFolder folder;
    layout.write(folder.path(), sample);
    RgbdCamera camera;
    camera.color = sample.lens;
    camera.depth_scale = 1000;
    if (layout.own_camera) write_camera_file(folder.path() / "camera.yaml", camera);
    std::string name = layout.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    if (name == "ScanNet_recording") {
      for (const auto& entry : fs::directory_iterator(folder.path()))
        corpus.add("sens", "raw", read_file(entry.path()));
    } else {
      corpus.add_folder("layouts", name, folder.path());
    }
  }
}

void add_connections(const Corpus& corpus) {
  const std::string camera =
      R"({"width": 8, "height": 6, "fx": 7, "fy": 7, "cx": 3.5, "cy": 2.5, "distortion": [0, 0, 0, 0, 0],)"
      R"( "depth_scale": 1000, "fps": 30})";
  const auto record = [](const std::string& header) {
    const auto size = static_cast<uint32_t>(header.size());
    return std::string(reinterpret_cast<const char*>(&size), sizeof size) + header;
  };
  std::string stream = record(R"({"kinloop": 1, "live": false, "camera": )" + camera + "}");
  stream += record(fmt::format(R"({{"stamp_ns": 1, "color": {{"encoding": "png", "bytes": {}}}, "depth": )"
                               R"({{"encoding": "png", "bytes": {}}}}})",
                               color_png().size(), depth_png().size())) +
            color_png() + depth_png();
  stream += record(R"({"stamp_ns": 2, "color": {"encoding": "bgr8", "bytes": 144}, "depth": )"
                   R"({"encoding": "32FC1", "bytes": 192}})") +
            std::string(144, '\x33') + std::string(192, '\x3f');
  corpus.add("stream", "two_frames", stream);
  stream += record(R"({"stamp_ns": 3, "color": {"encoding": "mono8", "bytes": 48}, "depth": )"
                   R"({"encoding": "16UC1", "bytes": 96}, "mask": {"encoding": "mono8", "bytes": 48}})") +
            std::string(48, '\x33') + std::string(96, '\x03') + std::string(48, '\x01');
  corpus.add("stream", "mask", stream);
  corpus.add("http", "page",
             "GET /?token=ab HTTP/1.1\r\nHost: localhost:8080\r\nOrigin: http://localhost:8080\r\n\r\n");
  corpus.add(
      "http", "feed",
      "GET /feed?since=7&run=run HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n");
  const std::string text = R"({"command":"pause"})", mask(4, '\0');
  corpus.add("websocket", "command",
             "\x81" + std::string(1, static_cast<char>(0x80U | text.size())) + mask + text);
  corpus.add("websocket", "ping_and_close", "\x89\x80" + mask + "\x88\x82" + mask + "\x03\xE8");
  corpus.add("websocket", "fragments", "\x01\x82" + mask + "{\"" + "\x80\x82" + mask + "a}");
}

}  // namespace
}  // namespace kinloop::fuzz

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: make_fuzz_seeds FOLDER\n", stderr);
    return 2;
  }
  const kinloop::fuzz::Corpus corpus(arguments[1]);
  kinloop::fuzz::add_text(corpus);
  kinloop::fuzz::add_cameras(corpus);
  kinloop::fuzz::add_images(corpus);
  kinloop::fuzz::add_depth(corpus);
  kinloop::fuzz::add_point_files(corpus);
  kinloop::fuzz::add_places(corpus);
  kinloop::fuzz::add_map(corpus);
  kinloop::fuzz::add_recordings(corpus);
  kinloop::fuzz::add_layouts(corpus);
  kinloop::fuzz::add_connections(corpus);
  return 0;
}
