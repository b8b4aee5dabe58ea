#include "dense/files/ply.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <fstream>
#include <string>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are written as memory has them");

constexpr size_t kVectorBytes = 3 * sizeof(float);
constexpr std::string_view kEnd = "end_header\n";
constexpr std::string_view kVertex = "element vertex ";
constexpr std::string_view kPoint = "property float x\nproperty float y\nproperty float z\n";
constexpr std::string_view kNormal = "property float nx\nproperty float ny\nproperty float nz\n";
constexpr std::string_view kColor = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

struct KinloopHeader {
  FileFrame frame;
  size_t count = 0;
  bool normals = false;
  size_t bytes = 0;  ///< of the header itself

  [[nodiscard]] size_t vertex_bytes() const { return (normals ? 2 : 1) * kVectorBytes + sizeof(Rgb); }
};

std::string text_of(const KinloopHeader& header) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment kinloop\n";
  for (const std::string& comment : format_frame_comments(header.frame)) text += "comment " + comment + "\n";
  fmt::format_to(std::back_inserter(text), "{}{}\n{}{}{}{}", kVertex, header.count, kPoint,
                 header.normals ? kNormal : "", kColor, kEnd);
  return text;
}

[[noreturn]] void throw_bad(const std::filesystem::path& path, const char* what) {
  throw InputError(fmt::format("{}: {}; give a map.ply written by kinloop", path.string(), what));
}

/// Removes and returns the first line of `text`.
std::string take_line(std::string_view& text) {
  const size_t end = std::min(text.find('\n'), text.size());
  std::string line(text.substr(0, end));
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// `path` names the file in errors.
KinloopHeader parse_header(std::string_view content, const std::filesystem::path& path) {
  constexpr std::string_view kComment = "comment ";
  constexpr const char* kWanted =
      "not a binary PLY cloud with float x y z, optional nx ny nz, and uchar red green blue";
  KinloopHeader header;
  std::string_view rest = content;
  if (take_line(rest) != "ply" || take_line(rest) != "format binary_little_endian 1.0")
    throw_bad(path, kWanted);
  std::vector<std::string> comments;
  while (rest.starts_with(kComment)) comments.push_back(take_line(rest).substr(kComment.size()));
  header.frame = parse_frame_comments(comments);
  const std::string vertex = take_line(rest);
  if (!vertex.starts_with(kVertex)) throw_bad(path, kWanted);
  const char* end_of_line = vertex.data() + vertex.size();
  const auto [end, error] = std::from_chars(vertex.data() + kVertex.size(), end_of_line, header.count);
  if (error != std::errc() || end != end_of_line) throw_bad(path, "the number of points is not a number");
  const auto take = [&](std::string_view text) {
    const bool there = rest.starts_with(text);
    if (there) rest.remove_prefix(text.size());
    return there;
  };
  if (!take(kPoint)) throw_bad(path, kWanted);
  header.normals = take(kNormal);
  if (!take(kColor) || !take(kEnd)) throw_bad(path, kWanted);
  header.bytes = content.size() - rest.size();
  return header;
}

}  // namespace

void write_ply(const std::filesystem::path& path, const ColoredCloud& cloud, const FileFrame& frame) {
  require(cloud.points.size() == cloud.colors.size(), "write_ply: expected one colour per point");
  const KinloopHeader header{frame, cloud.size(), !cloud.normals.empty()};
  require(!header.normals || cloud.normals.size() == cloud.size(),
          "write_ply: expected one normal per point");
  AtomicFile file(path);
  file.stream() << text_of(header);
  constexpr size_t kAtOnce = 4096;
  std::string buffer(kAtOnce * header.vertex_bytes(), '\0');
  for (size_t first = 0; first < cloud.size(); first += kAtOnce) {
    const size_t count = std::min(kAtOnce, cloud.size() - first);
    char* to = buffer.data();
    const auto put = [&to](const void* values, size_t bytes) {
      std::memcpy(to, values, bytes);
      to += bytes;
    };
    for (size_t i = first; i < first + count; ++i) {
      put(frame.to_file(cloud.points[i]).data(), kVectorBytes);
      if (header.normals) put(frame.to_file(cloud.normals[i]).data(), kVectorBytes);
      put(cloud.colors[i].data(), sizeof(Rgb));
    }
    file.stream().write(buffer.data(), to - buffer.data());
  }
  file.commit();
}

ColoredCloud read_ply(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  const KinloopHeader header = parse_header(bytes, path);
  if ((bytes.size() - header.bytes) / header.vertex_bytes() < header.count) throw_bad(path, "truncated");
  const Eigen::Quaterniond R_world_file = header.frame.R_file_world.conjugate();
  const char* from = bytes.data() + header.bytes;
  const auto take_vector = [&] {
    Eigen::Vector3f v;
    std::memcpy(v.data(), from, kVectorBytes);
    from += kVectorBytes;
    if (!v.allFinite()) throw_bad(path, "a coordinate is not a finite number");
    return header.frame.z_up ? Eigen::Vector3f((R_world_file * v.cast<double>()).cast<float>()) : v;
  };
  ColoredCloud cloud;
  cloud.points.reserve(header.count);
  cloud.colors.resize(header.count);
  for (size_t i = 0; i < header.count; ++i) {
    cloud.points.push_back(take_vector());
    if (header.normals) cloud.normals.push_back(take_vector());
    std::memcpy(cloud.colors[i].data(), from, sizeof(Rgb));
    from += sizeof(Rgb);
  }
  return cloud;
}

FileFrame read_ply_frame(const std::filesystem::path& path) {
  constexpr size_t kMaxBytes = 4096;
  std::string start(kMaxBytes, '\0');
  require_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<size_t>(stream.gcount()));
  return parse_header(start, path).frame;
}

}  // namespace kinloop
