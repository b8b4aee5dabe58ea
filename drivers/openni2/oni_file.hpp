#pragma once
// In: a recording (.oni) of OpenNI 1.5 or OpenNI 2. Out: its streams, and their images in the order of the
// file. The player of libOpenNI2 is not used: it crashes, now and then on intact files too
// (docs/recordings.md).

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "drivers/openni2/openni_image.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

enum class OniStreamKind { kColor, kDepth };

/// A stream of images. Its properties are those before the first image.
struct OniStream {
  OniStreamKind kind = OniStreamKind::kColor;
  std::string codec;  ///< "NONE", "JPEG", "16zT", "16zP"
  uint32_t width = 0, height = 0, fps = 0;
  OpenNiPixels pixels = OpenNiPixels::kRgb;
  bool mirrored = false;
  double horizontal_view_rad = 0, vertical_view_rad = 0;  ///< 0: not recorded
  size_t images = 0;                                      ///< in the file
};

/// An image as stored; valid until the next one is read.
struct OniImage {
  uint32_t node = 0;  ///< its stream
  int64_t stamp_ns = 0;
  Bytes data;
};

class OniFile {
 public:
  /// Reads all records but the images. Throws InputError if it is not a recording. Reads up to a cut or
  /// damage, which is reported.
  explicit OniFile(const std::filesystem::path& path);

  /// The streams by the number of their node.
  [[nodiscard]] const std::map<uint32_t, OniStream>& streams() const { return streams_; }

  /// Returns the next image; nullopt at the end.
  std::optional<OniImage> next();

  [[nodiscard]] const SkippedFrames& damage() const { return damage_; }

 private:
  struct Record {
    uint32_t type = 0, node = 0;
    Bytes fields;
    uint32_t payload_bytes = 0;
  };

  void read_header();
  void read_all_properties();
  void add_stream(uint32_t node, ByteReader fields);
  void set_property(const Record& record);
  std::optional<Record> read_record();
  std::optional<Bytes> read_block(uint64_t length, std::vector<uint8_t>& buffer);
  void stop(uint64_t at, const std::string& why);

  std::string name_;
  std::ifstream file_;
  uint64_t size_ = 0, position_ = 0;
  bool wide_ = true;  ///< positions in the file have 64 bits
  bool reported_ = false;
  std::map<uint32_t, OniStream> streams_;
  std::vector<uint8_t> header_, fields_, payload_;
  SkippedFrames damage_;
};

// In: depth compressed by OpenNI, in a recording. Out: its pixels.

/// Decodes depth of codec 16z to 16UC1. `with_table`: the values are indices into a table in front of them
/// (16zT), otherwise depth itself (16zP). Throws InputError if truncated or of another size.
cv::Mat decode_16z(Bytes bytes, cv::Size size, bool with_table);

}  // namespace kinloop
