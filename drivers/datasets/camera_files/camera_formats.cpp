#include "drivers/datasets/camera_files/camera_formats.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"

namespace kinloop {
namespace {

constexpr std::array kCameraFormats = {
    CameraFormat{"camera.yaml", read_own_camera},
    CameraFormat{"COLMAP cameras.txt", read_colmap},
    CameraFormat{"ORB-SLAM or stella_vslam settings", read_slam_settings},
    CameraFormat{"Kalibr camchain", read_kalibr},
    CameraFormat{"camodocal or VINS camera", read_camodocal},
    CameraFormat{"Basalt calibration", read_basalt},
    CameraFormat{"MATLAB camera parameters", read_matlab},
    CameraFormat{"Agisoft calibration", read_agisoft},
    CameraFormat{"Nerfstudio transforms.json", read_transforms},
    CameraFormat{"matrix in JSON or YAML", read_matrix_values},
    CameraFormat{"fx, fy, cx, cy in JSON or YAML", read_focal_lengths},
    CameraFormat{"matrix of numbers", read_matrix_numbers},
    CameraFormat{"fx fy cx cy [width height]", read_number_list},
};

bool is_yaml_name(const std::filesystem::path& file) {
  return file.extension() == ".yaml" || file.extension() == ".yml";
}

CameraDescription own_description(const CameraDocument& document) {
  CameraDescription description = description_of(document);
  description.camera = read_camera_text(document.text(), document.file());
  description.has_depth_scale = description.has_fps = description.is_complete = true;
  return description;
}

}  // namespace

std::span<const CameraFormat> camera_formats() {
  return kCameraFormats;
}

CameraDescription description_of(const CameraDocument& document) {
  CameraDescription description;
  description.source = document.file().string();
  return description;
}

std::optional<CameraDescription> read_own_camera(const CameraDocument& document) {
  const CameraValues values(document);
  bool own = values.has("fps") && values.has("depth_scale") &&
             (is_yaml_name(document.file()) || values.has("distortion") || values.has("model"));
  for (const char* key : {"T_color_depth", "depth_offset_s", "depth_shift_m", "rolling_shutter_s"})
    own = own || values.has(key);
  return own ? std::optional(own_description(document)) : std::nullopt;
}

std::optional<MatrixIntrinsics> intrinsics_of_matrix(std::span<const double> m) {
  constexpr size_t k3x3 = 9, k3x4 = 12, k4x4 = 16;
  constexpr double kTolerance = 1e-6;
  if (m.size() != k3x3 && m.size() != k3x4 && m.size() != k4x4) return std::nullopt;
  const size_t columns = m.size() == k3x3 ? 3 : 4;
  const auto read = [&](bool transposed) -> std::optional<MatrixIntrinsics> {
    const auto at = [&](size_t row, size_t column) {
      return transposed ? m[column * columns + row] : m[row * columns + column];
    };
    const auto is = [&](size_t row, size_t column, double value) {
      return std::abs(at(row, column) - value) <= kTolerance;
    };
    if (!is(1, 0, 0) || !is(2, 0, 0) || !is(2, 1, 0) || !is(2, 2, 1)) return std::nullopt;
    return MatrixIntrinsics{at(0, 0), at(1, 1), at(0, 2), at(1, 2)};
  };
  if (const auto rows = read(false)) return rows;
  return m.size() == k3x4 ? std::nullopt : read(true);
}

std::optional<CameraDescription> find_description(const std::filesystem::path& file) {
  const CameraDocument document = CameraDocument::read(file);
  for (const CameraFormat& format : kCameraFormats) {
    document.forget_used();
    if (auto description = format.read(document)) {
      description->format = format.name;
      return description;
    }
  }
  return std::nullopt;
}

CameraDescription read_camera_description(const std::filesystem::path& file) {
  if (auto description = find_description(file)) return *description;
  if (CameraDocument::read(file).text().find("[LEFT_CAM_") != std::string::npos) {
    throw InputError(fmt::format(
        "{}: the factory calibration of a ZED, of images that its SDK has not rectified; give the SDK's "
        "calibration_parameters.left_cam by --intrinsics fx,fy,cx,cy",
        file.string()));
  }
  if (is_yaml_name(file)) return own_description(CameraDocument::read(file));  // says which key is missing
  throw InputError(
      fmt::format("{}: no camera in a known format; write a camera.yaml, or use --intrinsics fx,fy,cx,cy",
                  file.string()));
}

}  // namespace kinloop
