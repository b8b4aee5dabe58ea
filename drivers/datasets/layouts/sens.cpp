// ScanNet's and BundleFusion's container .sens, version 4 (SensorData in ScanNet's SensReader). All numbers
// are little-endian:
//   uint32 version; uint64 length, name of the sensor
//   float[16] intrinsic and extrinsic of colour, intrinsic and extrinsic of depth
//   int32 compression of colour (1 PNG, 2 JPEG) and of depth (0 uint16, 1 zlib)
//   uint32 width and height of colour, of depth; float units per metre; uint64 count of frames
//   each: float[16] pose, uint64 times of colour and depth in microseconds, uint64 sizes, colour, depth

#include <array>
#include <fstream>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "drivers/datasets/reading/two_lenses.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

/// Reads the file from the front. Errors name the file and the byte.
class SensReader {
 public:
  explicit SensReader(const fs::path& file) : file_(file) {
    require_regular_file(file);
    stream_.open(file, std::ios::binary);
    std::error_code error;
    size_ = fs::file_size(file, error);
    if (!stream_ || error)
      throw InputError(fmt::format("{}: cannot be read; check its permissions", file.string()));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: at byte {}: {}", file_.string(), position(), what));
  }
  [[nodiscard]] bool has(uint64_t count) const { return count <= size_ - position_; }
  [[nodiscard]] uint64_t position() const { return position_; }

  void skip(uint64_t count) {
    require_left(count);
    position_ += count;
    stream_.seekg(static_cast<std::streamoff>(position_));
  }

  template <class Number>
  Number number() {
    require_left(sizeof(Number));
    std::array<uint8_t, sizeof(Number)> bytes{};
    stream_.read(reinterpret_cast<char*>(bytes.data()), bytes.size());
    if (!stream_) fail("the file cannot be read; was it cut short?");
    position_ += bytes.size();
    return ByteReader(bytes).number<Number>();
  }

  Eigen::Matrix4d matrix() {
    Eigen::Matrix4d m;
    for (Eigen::Index i = 0; i < m.size(); ++i) m(i / 4, i % 4) = static_cast<double>(number<float>());
    return m;
  }

  cv::Size size() {
    const auto width = number<uint32_t>(), height = number<uint32_t>();
    if (!is_plausible_size(width, height))
      fail(fmt::format("images of {} x {}; the file is damaged", width, height));
    return {static_cast<int>(width), static_cast<int>(height)};
  }

 private:
  void require_left(uint64_t count) const {
    if (!has(count)) fail("the file is truncated; copy it again");
  }

  std::ifstream stream_;
  fs::path file_;
  uint64_t size_ = 0, position_ = 0;
};

DepthEncoding depth_encoding(SensReader& bytes) {
  constexpr int32_t kPng = 1, kJpeg = 2, kRaw = 0, kZlib = 1;
  const auto color = bytes.number<int32_t>(), depth = bytes.number<int32_t>();
  if (color != kPng && color != kJpeg)
    bytes.fail(fmt::format("colour compression {}, where PNG (1) and JPEG (2) can be read", color));
  if (depth != kRaw && depth != kZlib)
    bytes.fail(fmt::format("depth compression {}, where none (0) and zlib (1) can be read", depth));
  return depth == kRaw ? DepthEncoding::kRawUint16 : DepthEncoding::kZlibUint16;
}

PinholeCamera lens_of(const Eigen::Matrix4d& k, cv::Size size, const fs::path& file) {
  return checked_lens(make_lens(size, k(0, 0), k(1, 1), k(0, 2), k(1, 2)), file);
}

/// A recording that was cut off keeps the frames before the cut.
void read_frames(SensReader& bytes, const fs::path& file, uint64_t count, RecordedSequence& sequence,
                 std::vector<std::optional<SE3>>& poses) {
  constexpr int64_t kNsPerMicrosecond = 1000;
  constexpr uint64_t kHeader = 16 * sizeof(float) + 4 * sizeof(uint64_t),
                     kMaxStamp = kMaxStampNs / kNsPerMicrosecond;
  for (uint64_t i = 0; i < count && bytes.has(kHeader); ++i) {
    poses.push_back(rigid_motion(bytes.matrix()));
    const auto color_stamp = std::min(bytes.number<uint64_t>(), kMaxStamp);
    const auto depth_stamp = std::min(bytes.number<uint64_t>(), kMaxStamp);
    const auto color_size = bytes.number<uint64_t>(), depth_size = bytes.number<uint64_t>();
    RecordedFrame frame{static_cast<int64_t>(color_stamp) * kNsPerMicrosecond,
                        static_cast<int64_t>(depth_stamp) * kNsPerMicrosecond,
                        {file, bytes.position(), color_size},
                        {file, 0, depth_size},
                        {},
                        0};
    if (!bytes.has(color_size) || !bytes.has(depth_size) || !bytes.has(color_size + depth_size)) break;
    frame.depth.offset = bytes.position() + color_size;
    bytes.skip(color_size + depth_size);
    if (color_size == 0 || depth_size == 0) {
      sequence.skipped.add(
          {fmt::format("frame {}", i), fmt::format("{}: frame {} lacks an image", file.string(), i)});
      poses.pop_back();
      continue;
    }
    sequence.frames.push_back(frame);
  }
  if (sequence.frames.empty()) bytes.fail("no complete frame; copy it again");
  if (sequence.frames.size() + sequence.skipped.size() < count)
    log::warn("{}: truncated at byte {}: {} of {} frames", file.string(), bytes.position(),
              sequence.frames.size(), count);
}

/// Some recorders write no times, or the same for many frames.
bool has_increasing_stamps(const std::vector<RecordedFrame>& frames) {
  for (size_t i = 1; i < frames.size(); ++i) {
    if (frames[i].stamp_ns <= frames[i - 1].stamp_ns) return false;
  }
  return frames.size() > 1;
}

fs::path sens_file(const fs::path& path, const FolderContents& contents) {
  if (!fs::is_directory(path)) return path.extension() == ".sens" ? path : fs::path();
  const std::string name = contents.find_file("", ".sens");
  return name.empty() ? fs::path() : path / name;
}

std::string sens_evidence(const fs::path& path, const FolderContents& contents) {
  return sens_file(path, contents).filename().string();
}

RecordedSequence read_sens(const fs::path& path) {
  constexpr uint32_t kVersion = 4;
  const fs::path file = sens_file(path, FolderContents(path));
  SensReader bytes(file);
  const auto version = bytes.number<uint32_t>();
  if (version != kVersion) bytes.fail(fmt::format("version {}, where {} can be read", version, kVersion));
  bytes.skip(bytes.number<uint64_t>());
  const Eigen::Matrix4d color_intrinsic = bytes.matrix(), color_extrinsic = bytes.matrix();
  const Eigen::Matrix4d depth_intrinsic = bytes.matrix(), depth_extrinsic = bytes.matrix();
  RecordedSequence sequence;
  sequence.layout = ".sens recording";
  sequence.depth_encoding = depth_encoding(bytes);
  const cv::Size color_size = bytes.size(), depth_size = bytes.size();
  const TwoLenses lenses{
      lens_of(color_intrinsic, color_size, file), lens_of(depth_intrinsic, depth_size, file),
      rigid_motion(color_extrinsic).value_or(SE3{}), rigid_motion(depth_extrinsic).value_or(SE3{})};
  sequence.camera = camera_of(lenses, static_cast<double>(bytes.number<float>()), file);
  sequence.sensor = DepthSensorModel::kStructuredLight;  // a Structure Sensor
  std::vector<std::optional<SE3>> poses;
  read_frames(bytes, file, bytes.number<uint64_t>(), sequence, poses);
  sequence.stamps_measured = has_increasing_stamps(sequence.frames);
  if (sequence.stamps_measured) {
    sequence.camera->fps = median_rate_hz(sequence.frames, sequence.camera->fps);
  } else {
    stamp_by_rate(sequence.frames, sequence.camera->fps);
  }
  sequence.ground_truth = truth_of(sequence.frames, [&](const RecordedFrame&, size_t i) { return poses[i]; });
  move_to_color(lenses, sequence.ground_truth);
  return sequence;
}

}  // namespace

SequenceLayout sens_layout() {
  return {"ScanNet recording", "*.sens", sens_evidence, read_sens};
}

}  // namespace kinloop
