#include "viewer/point_files/mesh_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

constexpr uint32_t kLeftOut = std::numeric_limits<uint32_t>::max();

/// From here on a float resolves less than a millimetre; typical of map projections.
constexpr double kOriginShiftThresholdM = 1e4;

}  // namespace

void MeshBuilder::add(const Eigen::Vector3d& point, const Rgb& color) {
  constexpr double kLargest = 1e30;  // its square still fits a float
  const bool usable = point.allFinite() && point.cwiseAbs().maxCoeff() < kLargest;
  index_of_.push_back(usable ? static_cast<uint32_t>(mesh_.points.size()) : kLeftOut);
  if (!usable) return;
  if (!origin_) {
    const bool far = point.cwiseAbs().maxCoeff() > kOriginShiftThresholdM;
    origin_ = far ? Eigen::Vector3d(point.array().round()) : Eigen::Vector3d::Zero();
  }
  mesh_.points.emplace_back((point - *origin_).cast<float>());
  if (colored_) mesh_.colors.push_back(color);
}

void MeshBuilder::add_face(const std::vector<size_t>& corners) {
  for (size_t i = 2; i < corners.size(); ++i) triangles_.push_back({corners[0], corners[i - 1], corners[i]});
}

ColoredMesh MeshBuilder::finish(const std::filesystem::path& path) {
  for (const auto& corners : triangles_) {
    Triangle triangle{};
    bool usable = true;
    for (size_t i = 0; i < corners.size(); ++i) {
      if (corners[i] >= index_of_.size()) {
        throw InputError(fmt::format("{}: a face refers to vertex {} of {}; the file is damaged",
                                     path.string(), corners[i], index_of_.size()));
      }
      triangle[i] = index_of_[corners[i]];
      usable = usable && triangle[i] != kLeftOut;
    }
    if (usable) mesh_.triangles.push_back(triangle);
  }
  if (!index_of_.empty() && mesh_.points.empty()) {
    throw InputError(
        fmt::format("{}: none of its {} points has finite coordinates", path.string(), index_of_.size()));
  }
  if (origin_ && !origin_->isZero()) {
    log::warn("{}: coordinates are large; shown relative to ({:.0f}, {:.0f}, {:.0f})", path.string(),
              origin_->x(), origin_->y(), origin_->z());
  }
  return std::move(mesh_);
}

uint8_t to_color_byte(double value, double full) {
  constexpr double kByte = 255;
  const double share = std::isfinite(value) ? std::clamp(value / full, 0.0, 1.0) : 0.0;
  return static_cast<uint8_t>(std::lround(kByte * share));
}

}  // namespace kinloop
