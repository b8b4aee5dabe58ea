#include "kinloop/dense/image_store.hpp"

#include <cmath>
#include <limits>
#include <new>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/anonymous_temp_file.hpp"
#include "kinloop/dense/depth_codec.hpp"
#include "kinloop/sensor/images/image_file.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"

namespace kinloop {

namespace {

[[noreturn]] void throw_no_room() {
  require_temporary_folder();
  throw InputError(
      fmt::format("{}: no space for the images of the map; free some space, set TMPDIR to another folder, or "
                  "raise --set dense.image_memory_mib and dense.surfel_memory_mib",
                  temporary_folder().string()));
}

/// Opens an unnamed file in the temporary folder; null on failure.
std::FILE* open_spill_file() {
  const int descriptor = open_anonymous_temp_file(temporary_folder());
  return descriptor < 0 ? nullptr : fdopen(descriptor, "w+b");
}

}  // namespace

size_t ByteStore::add(std::vector<uint8_t> bytes) {
  Entry entry;
  if (bytes_in_memory_ + bytes.size() > memory_limit_bytes_) {
    entry.file_offset = bytes_on_disk_;
    entry.file_bytes = bytes.size();
    spill(bytes);
  } else {
    bytes_in_memory_ += bytes.size();
    entry.bytes = std::move(bytes);
  }
  entries_.push_back(std::move(entry));
  return entries_.size() - 1;
}

std::vector<uint8_t> ByteStore::load(size_t index) const {
  require(index < entries_.size(), "ByteStore: no such piece");
  const Entry& entry = entries_[index];
  if (!entry.bytes.empty()) return entry.bytes;
  std::vector<uint8_t> bytes(entry.file_bytes);
  // pread does not move the file position, so threads do not disturb each other.
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t got = pread(fileno(file_.get()), bytes.data() + done, bytes.size() - done,
                              static_cast<off_t>(entry.file_offset + done));
    if (got <= 0) throw_no_room();
    done += static_cast<size_t>(got);
  }
  return bytes;
}

void ByteStore::spill(const std::vector<uint8_t>& bytes) {
  if (!file_) file_.reset(open_spill_file());
  if (!file_) throw_no_room();
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) == bytes.size();
  if (!written || std::fflush(file_.get()) != 0) throw_no_room();
  bytes_on_disk_ += bytes.size();
}

namespace {

// Both conversions have no branches, so that they are vectorised.

std::vector<uint16_t> to_units(const cv::Mat& depth_m, double units_per_m) {
  std::vector<uint16_t> units(depth_m.total());
  const auto scale = static_cast<float>(units_per_m);
  constexpr auto kMaxCount = static_cast<float>(std::numeric_limits<uint16_t>::max());
  const int cols = depth_m.cols;
  for (int row = 0; row < depth_m.rows; ++row) {
    const auto* depths = depth_m.ptr<float>(row);
    uint16_t* out = &units[static_cast<size_t>(row) * static_cast<size_t>(cols)];
    for (int col = 0; col < cols; ++col) {
      const float value = depths[col] * scale + 0.5F;
      const float known = ((value >= 1) & (value < kMaxCount)) ? value : 0.0F;
      out[col] = static_cast<uint16_t>(static_cast<int>(known));
    }
  }
  return units;
}

cv::Mat to_metres(const std::vector<uint16_t>& units, int rows, int cols, double units_per_m) {
  cv::Mat depth_m(rows, cols, CV_32FC1);
  auto* depths = depth_m.ptr<float>();
  const auto scale = static_cast<float>(units_per_m);
  for (size_t i = 0; i < units.size(); ++i) depths[i] = static_cast<float>(units[i]) / scale;
  return depth_m;
}

std::optional<std::vector<uint16_t>> try_unpack_depth(const std::vector<uint8_t>& bytes, size_t count) {
  try {
    return unpack_depth(bytes, count);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

size_t pixels_of(const EncodedImages& images) {
  return static_cast<size_t>(images.rows) * static_cast<size_t>(images.cols);
}

cv::Mat decode_color(const std::vector<uint8_t>& jpeg) {
  return decode_jpeg({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
}

std::vector<uint8_t> encode_color(const ColorImage& color, int jpeg_quality) {
  const std::string_view jpeg = color.jpeg();
  if (jpeg.empty()) return encode_jpeg(color.bgr(), jpeg_quality);
  return {jpeg.begin(), jpeg.end()};
}

}  // namespace

StoredImages encode_images(const ColorImage& color, const cv::Mat& depth_m,
                           const ImageStoreOptions& options) {
  require(depth_m.type() == CV_32FC1 && color.size() == depth_m.size(),
          "encode_images: expected depth 32FC1 of the size of the colour image");
  const int rows = depth_m.rows, cols = depth_m.cols;
  const auto units = to_units(depth_m, options.depth_scale);
  EncodedImages encoded{rows, cols, encode_color(color, options.jpeg_quality), pack_depth(units)};
  RgbdImages decoded{decode_color(encoded.color), to_metres(units, rows, cols, options.depth_scale)};
  if (decoded.color.size() != depth_m.size()) throw std::bad_alloc();  // it has been decoded before
  return {std::move(encoded), std::move(decoded)};
}

RgbdImages decode_images(const EncodedImages& images, const ImageStoreOptions& options) {
  const auto depth = try_unpack_depth(images.depth, pixels_of(images));
  cv::Mat color = decode_color(images.color);
  if (depth && color.size() == cv::Size(images.cols, images.rows))
    return {std::move(color), to_metres(*depth, images.rows, images.cols, options.depth_scale)};
  return {cv::Mat(images.rows, images.cols, CV_8UC3, cv::Scalar::all(0)),
          cv::Mat(images.rows, images.cols, CV_32FC1, cv::Scalar(0))};
}

bool is_decodable(const EncodedImages& images) {
  const std::string_view color(reinterpret_cast<const char*>(images.color.data()), images.color.size());
  return encoded_size(color) == cv::Size(images.cols, images.rows) &&
         try_unpack_depth(images.depth, pixels_of(images)).has_value();
}

size_t ImageStore::add(const EncodedImages& images) {
  std::vector<uint8_t> bytes;
  bytes.reserve(images.color.size() + images.depth.size());
  bytes.insert(bytes.end(), images.color.begin(), images.color.end());
  bytes.insert(bytes.end(), images.depth.begin(), images.depth.end());
  sizes_.push_back({images.rows, images.cols, images.color.size()});
  return bytes_.add(std::move(bytes));
}

EncodedImages ImageStore::encoded(size_t index) const {
  require(index < sizes_.size(), "ImageStore: no such image");
  const Size& size = sizes_[index];
  const std::vector<uint8_t> bytes = bytes_.load(index);
  const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(size.color_bytes);
  return {size.rows, size.cols, {bytes.begin(), middle}, {middle, bytes.end()}};
}

}  // namespace kinloop
