#include "drivers/openni2/oni_file.hpp"

#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {
namespace {

constexpr std::string_view kFileMagic = "NI10";
constexpr uint64_t kFileHeaderBytes = 24;
constexpr uint32_t kRecordMagic = 0x0052494E;  ///< "NIR"
constexpr uint32_t kMaxFieldBytes = 1U << 20, kMaxImageBytes = 1U << 28;
constexpr uint64_t kMaxStamp_us = uint64_t{1} << 53;

enum RecordType : uint32_t {
  kStreamAdded_1_0_0_4 = 0x02,
  kInteger = 0x03,
  kGeneral = 0x06,
  kImage = 0x0A,
  kEnd = 0x0B,
  kStreamAdded_1_0_0_5 = 0x0C,
  kStreamAdded = 0x0D
};
enum NodeType : int32_t { kDepthNode = 2, kColorNode = 3 };

/// Formats of OpenNI 1 in terms of OpenNI 2.
std::optional<OpenNiPixels> pixels_of_openni1(uint64_t format) {
  switch (format) {
    case 1:
      return OpenNiPixels::kRgb;
    case 2:
      return OpenNiPixels::kUyvy;
    case 3:
      return OpenNiPixels::kGray;
    case 5:
      return OpenNiPixels::kJpeg;
    default:
      return std::nullopt;
  }
}

std::string text_of(ByteReader& fields) {
  std::string text = fields.string();
  if (!text.empty()) text.pop_back();  // the terminating zero, made printable
  return text;
}

void set_integer(OniStream& stream, const std::string& name, uint64_t value) {
  if (name == "xnMirror") stream.mirrored = value != 0;
  if (name == "oniPixelFormat") stream.pixels = static_cast<OpenNiPixels>(value);
  if (name == "xnPixelFormat" && stream.kind == OniStreamKind::kColor)
    stream.pixels = pixels_of_openni1(value).value_or(stream.pixels);
}

/// Field of view as OpenNI 1 stores it: the geometry of its depth camera.
void set_view_from_geometry(OniStream& stream, ByteReader& value) {
  const auto distance = value.number<double>(), pixel_size = value.number<double>(),
             ratio = value.number<double>();
  stream.horizontal_view_rad = 2 * std::atan(pixel_size * ratio * stream.width / 2 / distance);
  stream.vertical_view_rad = 2 * std::atan(pixel_size * ratio * stream.height / 2 / distance);
}

void set_general(OniStream& stream, const std::string& name, ByteReader value) {
  if (name == "xnMapOutputMode") {
    stream.width = value.number<uint32_t>();
    stream.height = value.number<uint32_t>();
    stream.fps = value.number<uint32_t>();
  } else if (name == "xnFOV") {
    stream.horizontal_view_rad = value.number<double>();
    stream.vertical_view_rad = value.number<double>();
  } else if (name == "xnRealWorldTranslationData") {
    set_view_from_geometry(stream, value);
  }
}

}  // namespace

OniFile::OniFile(const std::filesystem::path& path) : name_(path.string()) {
  require_regular_file(path);
  file_.open(path, std::ios::binary);
  if (!file_) throw InputError(fmt::format("{}: cannot be opened; check the path and the rights", name_));
  size_ = std::filesystem::file_size(path);
  read_header();
  read_all_properties();
  position_ = kFileHeaderBytes;
}

void OniFile::read_header() {
  const auto header = read_block(kFileHeaderBytes, header_);
  if (!header || as_text(header->first(kFileMagic.size())) != kFileMagic)
    throw InputError(fmt::format("{}: not a recording of OpenNI ({} bytes, {}); record it again", name_,
                                 size_, header ? "another format" : "no header"));
  ByteReader fields(header->subspan(kFileMagic.size()));
  const auto major = fields.number<uint8_t>(), minor = fields.number<uint8_t>();
  const auto maintenance = fields.number<uint16_t>();
  const auto build = fields.number<uint32_t>();
  const std::tuple version(major, minor, maintenance, build);
  if (version < std::tuple(1, 0, 0, 4) || version > std::tuple(1, 0, 1, 0))
    throw InputError(
        fmt::format("{}: version {}.{}.{}.{} of the format; versions 1.0.0.4 to 1.0.1.0 can be read", name_,
                    major, minor, maintenance, build));
  wide_ = version == std::tuple(1, 0, 1, 0);
}

void OniFile::read_all_properties() {
  bool before_images = true;
  while (const auto record = read_record()) {
    if (record->type == kImage) {
      before_images = false;
      const auto stream = streams_.find(record->node);
      if (stream != streams_.end()) ++stream->second.images;
    } else if (before_images) {
      try {
        set_property(*record);
      } catch (const InputError& error) {
        throw InputError(fmt::format("{}: before byte {}: a damaged property ({}); record it again", name_,
                                     position_, error.what()));
      }
    }
    position_ += record->payload_bytes;
  }
  reported_ = true;
}

void OniFile::set_property(const Record& record) {
  ByteReader fields(record.fields);
  if (record.type == kStreamAdded || record.type == kStreamAdded_1_0_0_5 ||
      record.type == kStreamAdded_1_0_0_4)
    return add_stream(record.node, fields);
  if (record.type != kInteger && record.type != kGeneral) return;
  const auto stream = streams_.find(record.node);
  if (stream == streams_.end()) return;
  const std::string name = text_of(fields);
  ByteReader value(fields.block(fields.number<uint32_t>()));
  if (record.type == kInteger) {
    set_integer(stream->second, name, value.number<uint64_t>());
  } else {
    set_general(stream->second, name, value);
  }
}

void OniFile::add_stream(uint32_t node, ByteReader fields) {
  text_of(fields);  // its name
  const auto type = fields.number<int32_t>();
  if (type != kDepthNode && type != kColorNode) return;
  OniStream stream;
  stream.kind = type == kDepthNode ? OniStreamKind::kDepth : OniStreamKind::kColor;
  stream.pixels = type == kDepthNode ? OpenNiPixels::kDepth1Mm : OpenNiPixels::kRgb;
  stream.codec = printable(as_text(fields.block(4)));
  streams_.emplace(node, stream);
}

std::optional<OniImage> OniFile::next() {
  while (const auto record = read_record()) {
    if (record->type != kImage || !streams_.contains(record->node)) {
      position_ += record->payload_bytes;
      continue;
    }
    const uint64_t at = position_;
    const auto data = read_block(record->payload_bytes, payload_);
    if (!data) return std::nullopt;  // checked by read_record
    try {
      ByteReader fields(record->fields);
      const auto stamp_us = fields.number<uint64_t>();
      if (stamp_us > kMaxStamp_us) throw InputError(fmt::format("impossible time stamp {} us", stamp_us));
      return OniImage{record->node, static_cast<int64_t>(1000 * stamp_us), *data};
    } catch (const InputError& error) {
      damage_.add({name_, fmt::format("at byte {}: {}", at, error.what())});
    }
  }
  return std::nullopt;
}

std::optional<OniFile::Record> OniFile::read_record() {
  const uint64_t at = position_;
  const uint64_t header_bytes = wide_ ? 28 : 24;
  if (at == size_) return std::nullopt;
  const auto header = read_block(header_bytes, header_);
  if (!header) return stop(at, "a truncated record"), std::nullopt;
  ByteReader numbers(*header);
  if (numbers.number<uint32_t>() != kRecordMagic) return stop(at, "not a record"), std::nullopt;
  Record record;
  record.type = numbers.number<uint32_t>();
  record.node = numbers.number<uint32_t>();
  const auto bytes = numbers.number<uint32_t>();  // of header and fields
  record.payload_bytes = numbers.number<uint32_t>();
  if (record.type == kEnd) return std::nullopt;
  if (bytes < header_bytes || bytes > kMaxFieldBytes || record.payload_bytes > kMaxImageBytes)
    return stop(at, "a record of impossible size"), std::nullopt;
  const auto fields = read_block(bytes - header_bytes, fields_);
  if (!fields || record.payload_bytes > size_ - position_)
    return stop(at, "a truncated record"), std::nullopt;
  record.fields = *fields;
  return record;
}

std::optional<Bytes> OniFile::read_block(uint64_t length, std::vector<uint8_t>& buffer) {
  if (length > size_ - position_) return std::nullopt;
  buffer.resize(static_cast<size_t>(length));
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position_));
  file_.read(reinterpret_cast<char*>(buffer.data()), static_cast<std::streamsize>(length));
  if (!file_) return std::nullopt;
  position_ += length;
  return Bytes(buffer);
}

void OniFile::stop(uint64_t at, const std::string& why) {
  if (!reported_) damage_.add({name_, fmt::format("at byte {}: {}; the rest is not read", at, why)});
  position_ = size_;
}

}  // namespace kinloop
