#include "tools/export/las.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_stream.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {
namespace {

constexpr double kStepM = 1e-4;
constexpr uint16_t kHeaderBytes = 227, kPointBytes = 26;
constexpr uint8_t kPointFormat = 2;  // with colour, without time

template <class T>
void put(std::string& bytes, T value) {
  put_values(bytes, &value, 1);
}

/// Appends `text`, cut or filled with zeros to `size` bytes.
void put_text(std::string& bytes, std::string text, size_t size) {
  text.resize(size, '\0');
  bytes += text;
}

/// A point as stored: its coordinates in steps.
using Steps = Eigen::Array<int32_t, 3, 1>;

struct LasPoints {
  std::vector<Steps> steps;
  std::vector<Rgb> colors;
  Eigen::Array3d low = Eigen::Array3d::Zero(), high = Eigen::Array3d::Zero();  ///< m
};

LasPoints las_points(const std::filesystem::path& path, const ColoredCloud& cloud, const FileFrame& frame) {
  LasPoints points;
  Eigen::Array<int32_t, 3, 1> low = Steps::Constant(std::numeric_limits<int32_t>::max()), high = -low;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Array3d p = frame.to_file(cloud.points[i]).cast<double>().array() / kStepM;
    if (!p.isFinite().all()) continue;
    if (p.abs().maxCoeff() > std::numeric_limits<int32_t>::max()) {
      throw InputError(fmt::format("{}: a point is {:.0f} km from the origin, too far for LAS; write .ply",
                                   path.string(), p.abs().maxCoeff() * kStepM / 1e3));
    }
    points.steps.emplace_back(p.round().cast<int32_t>());
    points.colors.push_back(cloud.colors[i]);
    low = low.min(points.steps.back()), high = high.max(points.steps.back());
  }
  if (points.steps.size() > std::numeric_limits<uint32_t>::max())
    throw InputError(fmt::format("{}: too many points for LAS; write .ply", path.string()));
  if (!points.steps.empty())
    points.low = kStepM * low.cast<double>(), points.high = kStepM * high.cast<double>();
  return points;
}

/// A variable length record with a text about the file.
std::string text_record(const FileFrame& frame) {
  constexpr uint16_t kTextAreaDescription = 3;
  std::string text;
  for (const std::string& comment : format_frame_comments(frame)) text += comment + "\n";
  std::string bytes;
  put<uint16_t>(bytes, 0);
  put_text(bytes, "LASF_Spec", 16);
  put(bytes, kTextAreaDescription);
  put(bytes, static_cast<uint16_t>(text.size() + 1));
  put_text(bytes, "frame of the coordinates", 32);
  return bytes + text + '\0';
}

std::string header(const LasPoints& points, size_t record_bytes) {
  const auto count = static_cast<uint32_t>(points.steps.size());
  std::string bytes = "LASF";
  put_text(bytes, {}, 2 + 2 + 16);  // source, encoding, project
  bytes += {1, 2};                  // version 1.2
  put_text(bytes, "EXTRACTION", 32);
  put_text(bytes, "kinloop", 32);
  put_text(bytes, {}, 2 + 2);  // no date: the same map gives the same file
  put(bytes, kHeaderBytes);
  put(bytes, static_cast<uint32_t>(kHeaderBytes + record_bytes));
  put<uint32_t>(bytes, 1);  // records
  put(bytes, kPointFormat);
  put(bytes, kPointBytes);
  put(bytes, count);
  for (const uint32_t returned : {count, 0U, 0U, 0U, 0U}) put(bytes, returned);
  for (const double scale : {kStepM, kStepM, kStepM, 0.0, 0.0, 0.0}) put(bytes, scale);  // and offset
  for (int axis = 0; axis < 3; ++axis) {
    put(bytes, points.high[axis]);
    put(bytes, points.low[axis]);
  }
  return bytes;
}

}  // namespace

void write_las(const std::filesystem::path& path, const ColoredCloud& cloud, const FileFrame& frame) {
  require(cloud.points.size() == cloud.colors.size(), "write_las: expected one colour per point");
  constexpr uint8_t kOnlyReturn = 1 | 1 << 3;  // the first of one
  constexpr int kTo16Bits = 257;
  const LasPoints points = las_points(path, cloud, frame);
  const std::string record = text_record(frame);
  std::string bytes = header(points, record.size()) + record;
  bytes.reserve(bytes.size() + points.steps.size() * kPointBytes);
  for (size_t i = 0; i < points.steps.size(); ++i) {
    put_values(bytes, points.steps[i].data(), 3);
    put<uint16_t>(bytes, 0);  // intensity
    put(bytes, kOnlyReturn);
    put_text(bytes, {}, 1 + 1 + 1 + 2);  // class, angle, user data, source
    for (const uint8_t channel : points.colors[i]) put(bytes, static_cast<uint16_t>(channel * kTo16Bits));
  }
  write_file(path, bytes);
}

}  // namespace kinloop
