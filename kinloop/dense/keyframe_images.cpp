#include "kinloop/dense/keyframe_images.hpp"

#include <cmath>
#include <filesystem>
#include <limits>

#include <fcntl.h>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/dense/depth_codec.hpp"

namespace kinloop {
namespace {

std::vector<uint16_t> to_units(const cv::Mat& depth_m, double units_per_m) {
  std::vector<uint16_t> units;
  units.reserve(depth_m.total());
  const auto scale = static_cast<float>(units_per_m);
  constexpr auto kMost = static_cast<float>(std::numeric_limits<uint16_t>::max());
  for (int row = 0; row < depth_m.rows; ++row) {
    const auto* depths = depth_m.ptr<float>(row);
    for (int col = 0; col < depth_m.cols; ++col) {
      const float value = depths[col] * scale + 0.5F;
      units.push_back(value >= 1 && value < kMost ? static_cast<uint16_t>(value) : uint16_t{0});
    }
  }
  return units;
}

cv::Mat to_metres(const std::vector<uint16_t>& units, int rows, int cols, double units_per_m) {
  cv::Mat depth_m(rows, cols, CV_32FC1);
  auto* depths = depth_m.ptr<float>();
  for (size_t i = 0; i < units.size(); ++i) depths[i] = static_cast<float>(units[i] / units_per_m);
  return depth_m;
}

/// TMPDIR, else /tmp; the system's answer throws where TMPDIR is no folder.
std::filesystem::path temporary_folder() {
  std::error_code error;
  const auto folder = std::filesystem::temp_directory_path(error);
  return error ? std::filesystem::path("TMPDIR") : folder;
}

[[noreturn]] void throw_no_room() {
  throw InputError(fmt::format(
      "{}: cannot hold the images of the map; free some space there, set TMPDIR to another folder, or "
      "raise --set dense.image_memory_mib",
      temporary_folder().string()));
}

/// A file in the temporary folder (TMPDIR) that no longer has a name; null when there can be none.
std::FILE* open_nameless_file() {
  std::string name = (temporary_folder() / "kinloop_images_XXXXXX").string();
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) return nullptr;
  unlink(name.c_str());
  return fdopen(descriptor, "w+b");
}

}  // namespace

size_t KeyframeImages::add(const cv::Mat& color, const cv::Mat& depth_m) {
  require(color.type() == CV_8UC3 && depth_m.type() == CV_32FC1 && color.size() == depth_m.size(),
          "KeyframeImages: colour 8UC3 and depth 32FC1 of the same size");
  EncodedImages images{color.rows, color.cols, {}, pack_depth(to_units(depth_m, options_.depth_scale))};
  cv::imencode(".jpg", color, images.color, {cv::IMWRITE_JPEG_QUALITY, options_.jpeg_quality});
  return add(images);
}

size_t KeyframeImages::add(const EncodedImages& images) {
  Entry entry{images.rows, images.cols, images.color.size(), images.depth.size(), 0, {}};
  entry.bytes.reserve(entry.color_bytes + entry.depth_bytes);
  entry.bytes.insert(entry.bytes.end(), images.color.begin(), images.color.end());
  entry.bytes.insert(entry.bytes.end(), images.depth.begin(), images.depth.end());

  if (bytes_in_memory_ + entry.bytes.size() > options_.memory_limit_bytes) {
    entry.file_offset = bytes_on_disk_;
    spill(entry.bytes);
    entry.bytes = {};
  }
  bytes_in_memory_ += entry.bytes.size();
  entries_.push_back(std::move(entry));
  return entries_.size() - 1;
}

RgbdImages KeyframeImages::load(size_t index) const {
  const EncodedImages images = encoded(index);
  const auto depth =
      unpack_depth(images.depth, static_cast<size_t>(images.rows) * static_cast<size_t>(images.cols));
  return {cv::imdecode(images.color, cv::IMREAD_COLOR),
          to_metres(depth, images.rows, images.cols, options_.depth_scale)};
}

EncodedImages KeyframeImages::encoded(size_t index) const {
  require(index < entries_.size(), "KeyframeImages: no such image");
  const Entry& entry = entries_[index];
  const std::vector<uint8_t> from_file = entry.bytes.empty() ? bytes_of(entry) : std::vector<uint8_t>();
  const std::vector<uint8_t>& bytes = entry.bytes.empty() ? from_file : entry.bytes;
  const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(entry.color_bytes);
  return {entry.rows, entry.cols, {bytes.begin(), middle}, {middle, bytes.end()}};
}

void KeyframeImages::spill(const std::vector<uint8_t>& bytes) {
  if (!file_) file_.reset(open_nameless_file());
  if (!file_) throw_no_room();
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) == bytes.size();
  if (!written || std::fflush(file_.get()) != 0) throw_no_room();
  bytes_on_disk_ += bytes.size();
}

std::vector<uint8_t> KeyframeImages::bytes_of(const Entry& entry) const {
  std::vector<uint8_t> bytes(entry.color_bytes + entry.depth_bytes);
  // pread leaves the position of the file alone, so that threads do not disturb each other.
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t got = pread(fileno(file_.get()), bytes.data() + done, bytes.size() - done,
                              static_cast<off_t>(entry.file_offset + done));
    if (got <= 0) throw_no_room();
    done += static_cast<size_t>(got);
  }
  return bytes;
}

}  // namespace kinloop
