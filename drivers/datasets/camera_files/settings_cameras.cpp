// YAML files of programs that calibrate or map: ORB-SLAM2, ORB-SLAM3, stella_vslam and Kalibr.

#include <algorithm>

#include <fmt/format.h>

#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// "Camera" or, in ORB-SLAM3, "Camera1".
std::string camera_prefix(const CameraValues& values) {
  for (const char* prefix : {"Camera1", "Camera"}) {
    if (values.has(fmt::format("{}.fx", prefix))) return prefix;
  }
  return {};
}

DistortionModel settings_model(const CameraValues& values) {
  const std::string model = values.word({"Camera.type", "Camera.model"});
  if (model == "kannalabrandt8" || model == "fisheye") return DistortionModel::kFisheye;
  for (const char* known : {"", "pinhole", "perspective", "rectified"}) {
    if (model == known) return DistortionModel::kOpenCv;
  }
  values.document().reject(model, fmt::format("the camera model '{}', which kinloop does not have; use "
                                              "--camera FILE with another one",
                                              model));
}

std::vector<double> settings_distortion(const CameraValues& values, const std::string& prefix,
                                        DistortionModel model) {
  const auto at = [&](const char* key) { return values.number({fmt::format("{}.{}", prefix, key)}); };
  std::vector<double> coefficients;
  if (model == DistortionModel::kFisheye) {
    for (const char* key : {"k1", "k2", "k3", "k4"}) coefficients.push_back(at(key).value_or(0));
  } else {
    for (const char* key : {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"})
      coefficients.push_back(at(key).value_or(0));
  }
  return coefficients;
}

/// The keys of the camera: those with its prefix, or in its object.
void require_settings_understood(const CameraDocument& document, const std::string& prefix) {
  const nlohmann::json& all = document.values();
  if (const auto found = all.find(prefix); found != all.end()) require_understood(document, *found);
  for (const auto& [key, value] : all.items()) {
    if (!key.starts_with(prefix + ".") || document.is_used(value)) continue;
    const std::string name = key.substr(prefix.size() + 1);
    require_understood(document, nlohmann::json{{name, value}});
  }
}

}  // namespace

std::optional<CameraDescription> read_slam_settings(const CameraDocument& document) {
  const CameraValues values(document);
  const std::string prefix = camera_prefix(values);
  if (prefix.empty()) return std::nullopt;
  const auto required = [&](const char* key) { return values.required({fmt::format("{}.{}", prefix, key)}); };
  CameraDescription description = description_of(document);
  const double fx = required("fx"), fy = required("fy"), cx = required("cx"), cy = required("cy");
  set_intrinsics(description, fx, fy, cx, cy);
  const auto width = values.number({"Camera.width", "Camera.cols"});
  const auto height = values.number({"Camera.height", "Camera.rows"});
  if (width && height) set_size(description, *width, *height);
  const DistortionModel model = settings_model(values);
  set_distortion(description, settings_distortion(values, prefix, model), model);
  if (const auto factor = values.number(
          {"RGBD.DepthMapFactor", "DepthMapFactor", "Preprocessing.depthmap_factor", "depthmap_factor"}))
    set_depth_scale(description, *factor);
  if (const auto fps = values.number({"Camera.fps"})) set_fps(description, *fps);
  require_settings_understood(document, prefix);
  return description;
}

std::optional<CameraDescription> read_kalibr(const CameraDocument& document) {
  constexpr size_t kPinhole = 4, kSize = 2;
  const CameraValues chain(document);
  const nlohmann::json* first = chain.find({"cam0"});
  if (first == nullptr || !CameraValues(document, *first).has("intrinsics")) return std::nullopt;
  const CameraValues camera(document, *first);
  const std::string model = camera.word({"camera_model"}), lens = camera.word({"distortion_model"});
  const auto k = camera.numbers({"intrinsics"}), d = camera.numbers({"distortion_coeffs"});
  const bool fisheye = lens == "equidistant", radtan = lens == "radtan" || lens == "none" || lens.empty();
  if (model != "pinhole" || k.size() != kPinhole || (!fisheye && !radtan)) {
    document.reject("cam0",
                    "cam0 is not a pinhole camera with radtan or equidistant distortion; calibrate "
                    "it with --models pinhole-radtan");
  }
  CameraDescription description = description_of(document);
  set_intrinsics(description, k[0], k[1], k[2], k[3]);
  if (const auto size = camera.numbers({"resolution"}); size.size() == kSize)
    set_size(description, size[0], size[1]);
  set_distortion(description, d, fisheye ? DistortionModel::kFisheye : DistortionModel::kOpenCv);
  require_understood(document, camera.object());
  return description;
}

}  // namespace kinloop
