// What reading costs beyond decoding: the same frames in every layout and container that the tests can write.
// Prints CPU milliseconds per frame of each source, of decoding its images from memory, and their ratio, each
// the least of several rounds in turn. Depth is registered where the container demands it, in both.
//
//   bench_reading SEQUENCE [FRAMES] [ROUNDS]

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <unistd.h>

#include "drivers/azure/azure_source.hpp"
#include "drivers/bags/chunk_decompression.hpp"
#include "drivers/bags/message_file.hpp"
#include "drivers/datasets/open_sequence.hpp"
#include "drivers/datasets/reading/images/depth_image.hpp"
#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/datasets/recorded_source.hpp"
#include "drivers/image_files/image_file.hpp"
#include "drivers/openni2/oni_source.hpp"
#include "drivers/ros/bag_source.hpp"
#include "drivers/ros/messages/ros_image.hpp"
#include "drivers/stream/stream_source.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "tests/drivers/bag_writers.hpp"
#include "tests/drivers/layout_writers.hpp"
#include "tests/drivers/oni_writer.hpp"
#include "tests/drivers/ros1_bag_writer.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using Open = std::function<std::unique_ptr<FrameSource>()>;
using Decode = std::function<void()>;

constexpr double kMillimetre = 1e-3;

double cpu_ms() {
  std::timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Measures sources of as many frames as the sample has.
class Table {
 public:
  Table(size_t frames, int rounds) : frames_(static_cast<double>(frames)), rounds_(rounds) {
    std::printf("%-34s%12s%12s%8s\n", "source", "read, ms", "decode, ms", "ratio");
  }

  /// `decode` decodes the images of all frames.
  void add(const std::string& name, const Open& open, const Decode& decode) const {
    double read_ms = std::numeric_limits<double>::infinity(), decode_ms = read_ms;
    for (int i = 0; i < rounds_; ++i) {
      const auto source = open();
      const double start = cpu_ms();
      size_t count = 0;
      while (source->next()) ++count;
      const double middle = cpu_ms();
      decode();
      decode_ms = std::min(decode_ms, cpu_ms() - middle);
      read_ms = std::min(read_ms, middle - start);
      if (static_cast<double>(count) != frames_) std::printf("%s: only %zu frames\n", name.c_str(), count);
    }
    std::printf("%-34s%12.2f%12.2f%8.2f\n", name.c_str(), read_ms / frames_, decode_ms / frames_,
                read_ms / decode_ms);
    std::fflush(stdout);
  }

 private:
  double frames_;
  int rounds_;
};

/// The first frames of a sequence, with depth in millimetres.
test::Sample sample_of(const std::string& sequence, size_t frames) {
  const auto source = open_sequence(sequence);
  test::Sample sample;
  sample.lens = source->camera().color;
  sample.lens.lens = {};
  while (sample.size() < frames) {
    const auto frame = source->next();
    if (!frame) break;
    cv::Mat depth_mm;
    frame->depth_m.convertTo(depth_mm, CV_16UC1, 1 / kMillimetre);
    const auto stamp_ns = static_cast<int64_t>(1e9 * static_cast<double>(sample.size()) / 30);
    sample.colors.push_back(frame->color.bgr().clone());
    sample.depths_mm.push_back(depth_mm);
    sample.truth.push_back({stamp_ns, {}});
  }
  return sample;
}

void add_layouts(const Table& table, const test::Sample& sample) {
  RgbdCamera camera;
  camera.color = sample.lens;
  camera.depth_scale = 1 / kMillimetre;
  for (const test::LayoutWriter& layout : test::layout_writers()) {
    const test::TempFolder folder;
    layout.write(folder.path(), sample);
    if (layout.own_camera) write_camera_file(folder.path() / "camera.yaml", camera);
    const OpenedSequence opened = read_sequence(folder.path());
    if (!opened.sequence.video.empty()) continue;  // nothing but the video decoder
    std::vector<std::pair<std::string, std::string>> images;
    for (const RecordedFrame& frame : opened.sequence.frames)
      images.emplace_back(read_bytes(frame.color), read_bytes(frame.depth));
    const PinholeCamera& lens = opened.camera.depth ? *opened.camera.depth : opened.camera.color;
    table.add(
        layout.name, [&] { return open_sequence(folder.path().string()); },
        [&] {
          for (const auto& [color, depth] : images) {
            static_cast<void>(decode_color_image(color, "color"));
            static_cast<void>(decode_depth(depth, "depth", opened.sequence.depth_encoding,
                                           {lens.width, lens.height}, opened.camera.depth_scale));
          }
        });
  }
}

/// Images in the messages of a bag, raw or compressed as JPEG and PNG.
struct BagImages {
  bool compressed = false;
  std::vector<std::string> colors, depths;
};

BagImages bag_images(const test::Sample& sample, bool compressed) {
  BagImages images{compressed, {}, {}};
  for (size_t i = 0; i < sample.size(); ++i) {
    if (compressed) {
      const auto jpeg = encode_jpeg(sample.colors[i], 95);
      images.colors.emplace_back(jpeg.begin(), jpeg.end());
      images.depths.push_back(std::string(12, '\0') + test::encoded(sample.depths_mm[i], ".png"));
    } else {
      images.colors.push_back(test::pixels_of(sample.colors[i]));
      images.depths.push_back(test::pixels_of(sample.depths_mm[i]));
    }
  }
  return images;
}

void decode(const BagImages& images, const PinholeCamera& lens) {
  const auto width = static_cast<size_t>(lens.width);
  for (size_t i = 0; i < images.colors.size(); ++i) {
    if (images.compressed) {
      static_cast<void>(color_from_compressed(as_bytes(images.colors[i])));
      static_cast<void>(depth_from_compressed("16UC1; compressedDepth", as_bytes(images.depths[i])));
    } else {
      static_cast<void>(
          color_from({lens.width, lens.height, 3 * width, "bgr8", false, as_bytes(images.colors[i])}));
      static_cast<void>(
          depth_from({lens.width, lens.height, 2 * width, "16UC1", false, as_bytes(images.depths[i])}));
    }
  }
}

constexpr const char* kInfoTopic = "/camera/color/camera_info";
constexpr const char* kColorTopic = "/camera/color/image_raw";
constexpr const char* kDepthTopic = "/camera/aligned_depth_to_color/image_raw";

test::WrittenBag bag_of(const test::Sample& sample, const BagImages& images, test::Serialization kind) {
  test::WrittenBag bag = {
      {kInfoTopic, "sensor_msgs/msg/CameraInfo", 1, test::info_message(kind, sample.lens)}};
  for (size_t i = 0; i < sample.size(); ++i) {
    const int64_t stamp = 1 + sample.truth[i].stamp_ns;
    if (images.compressed) {
      const std::string type = "sensor_msgs/msg/CompressedImage";
      bag.push_back({std::string(kColorTopic) + "/compressed", type, stamp,
                     test::compressed_message(kind, stamp, "jpeg", images.colors[i])});
      bag.push_back({std::string(kDepthTopic) + "/compressedDepth", type, stamp,
                     test::compressed_message(kind, stamp, "16UC1; compressedDepth", images.depths[i])});
    } else {
      const std::string type = "sensor_msgs/msg/Image";
      bag.push_back({kColorTopic, type, stamp, test::image_message(kind, stamp, sample.colors[i], "bgr8")});
      bag.push_back(
          {kDepthTopic, type, stamp, test::image_message(kind, stamp, sample.depths_mm[i], "16UC1")});
    }
  }
  return bag;
}

std::string ros1_bytes(const test::WrittenBag& bag) {
  test::Ros1BagWriter writer;
  for (const test::WrittenMessage& m : bag) writer.add(m.topic, ros1_type(m.type), m.log_ns, m.data);
  return writer.bytes();
}

void add_bags(const Table& table, const test::Sample& sample) {
  const test::TempFolder folder;
  for (const bool compressed : {false, true}) {
    const BagImages images = bag_images(sample, compressed);
    const std::string kind = compressed ? ", JPEG and PNG" : ", raw images";
    const auto add = [&](const std::string& name, const fs::path& path) {
      table.add(
          name + kind, [&] { return open_bag(path, {}); }, [&] { decode(images, sample.lens); });
    };
    const auto ros2 = bag_of(sample, images, test::Serialization::kCdrLittle);
    add("ROS 1 bag", folder.write("a.bag", ros1_bytes(bag_of(sample, images, test::Serialization::kRos1))));
    add("MCAP", folder.write("a.mcap", test::mcap_bytes(ros2, {})));
    write_db3(folder.path() / "a.db3", ros2);
    add("SQLite", folder.path() / "a.db3");
  }
}

/// Chunks of raw images: decompressing them is part of decoding.
void add_compressed_chunks(const Table& table, const test::Sample& sample) {
  const test::TempFolder folder;
  const BagImages images = bag_images(sample, false);
  const auto ros2 = bag_of(sample, images, test::Serialization::kCdrLittle);
  for (const char* compression : {"lz4", "zstd"}) {
    test::McapLayout layout;
    layout.compression = compression;
    const auto path = folder.write("a.mcap", test::mcap_bytes(ros2, layout));
    std::vector<std::pair<std::string, size_t>> packed;
    for (const test::WrittenMessage& m : ros2)
      packed.emplace_back(test::compressed(compression, m.data), m.data.size());
    table.add(
        fmt::format("MCAP, {} chunks of raw images", compression), [&] { return open_bag(path, {}); },
        [&] {
          for (const auto& [bytes, size] : packed)
            static_cast<void>(decompressed(compression, as_bytes(bytes), size));
          decode(images, sample.lens);
        });
  }
}

void add_oni(const Table& table, const test::Sample& sample) {
  const cv::Size size(sample.lens.width, sample.lens.height);
  const auto frames = static_cast<uint32_t>(sample.size());
  const test::OniWriterStream depth{1, 2, "NONE", 100, size}, color{2, 3, "NONE", 200, size};
  std::string bytes = test::oni_header() + test::oni_stream(depth, frames) + test::oni_stream(color, frames) +
                      test::oni_data_begin(1, frames) + test::oni_data_begin(2, frames);
  for (uint32_t i = 0; i < frames; ++i) {
    bytes += test::oni_image(2, 33'333 * (i + 1), i + 1, test::pixels_of(sample.colors[i]));
    bytes += test::oni_image(1, 33'333 * (i + 1), i + 1, test::pixels_of(sample.depths_mm[i]));
  }
  const test::TempFolder folder;
  const auto path = folder.write("a.oni", bytes + test::oni_end());
  const auto width = static_cast<size_t>(size.width);
  table.add(
      "OpenNI (.oni), raw images", [&] { return open_oni_recording(path, {}); },
      [&] {
        for (size_t i = 0; i < sample.size(); ++i) {
          const Bytes rgb(sample.colors[i].data, 3 * sample.colors[i].total());
          const Bytes units(sample.depths_mm[i].data, 2 * sample.depths_mm[i].total());
          static_cast<void>(color_from({size.width, size.height, 3 * width, "rgb8", false, rgb}));
          static_cast<void>(depth_from({size.width, size.height, 2 * width, "16UC1", false, units}));
        }
      });
}

std::string stream_record(const std::string& header, const std::string& data = {}) {
  const auto size = static_cast<uint32_t>(header.size());
  return std::string(reinterpret_cast<const char*>(&size), sizeof size) + header + data;
}

void add_stream(const Table& table, const test::Sample& sample) {
  RgbdCamera camera;
  camera.color = sample.lens;
  camera.depth_scale = 1 / kMillimetre;
  const BagImages images = bag_images(sample, false);
  std::string bytes = stream_record(R"({"kinloop": 1, "live": false})");
  for (size_t i = 0; i < sample.size(); ++i) {
    bytes +=
        stream_record(fmt::format(R"({{"stamp_ns": {}, "color": {{"encoding": "bgr8", "bytes": {}}}, )"
                                  R"("depth": {{"encoding": "16UC1", "bytes": {}}}}})",
                                  sample.truth[i].stamp_ns, images.colors[i].size(), images.depths[i].size()),
                      images.colors[i] + images.depths[i]);
  }
  const test::TempFolder folder;
  const auto path = folder.write("stream", bytes);
  const auto open = [&] {
    FILE* file = std::fopen(path.c_str(), "rb");
    ByteStream stream((Descriptor(::dup(fileno(file)))));
    std::fclose(file);
    return open_stream(std::move(stream), "stream", camera);
  };
  table.add("stream, raw images", open, [&] { decode(images, sample.lens); });
}

}  // namespace
}  // namespace kinloop

int main(int count, char** arguments) {
  if (count < 2 || count > 4) {
    std::fputs("usage: bench_reading SEQUENCE [FRAMES] [ROUNDS]\n", stderr);
    return 2;
  }
  const auto number = [&](int place, int usual) {
    return place < count ? std::atoi(arguments[place]) : usual;
  };
  const auto sample = kinloop::sample_of(arguments[1], static_cast<size_t>(number(2, 30)));
  const kinloop::Table table(sample.size(), number(3, 5));
  kinloop::add_layouts(table, sample);
  kinloop::add_bags(table, sample);
  kinloop::add_compressed_chunks(table, sample);
  kinloop::add_oni(table, sample);
  kinloop::add_stream(table, sample);
  return 0;
}
