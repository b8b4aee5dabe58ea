// JSON and YAML with the usual keys: OpenCV's FileStorage, ROS's camera_info, Open3D, BOP, RealSense, Azure
// Kinect and what people write by hand; and transforms.json of Nerfstudio and instant-ngp.

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/text/lower_case.hpp"

namespace kinloop {
namespace {

void read_stated_size(const CameraValues& values, CameraDescription& description) {
  constexpr size_t kSides = 2;
  const auto width = values.number({"image_width", "width", "w", "W", "cols", "img_width", "imageWidth"});
  const auto height =
      values.number({"image_height", "height", "h", "H", "rows", "img_height", "imageHeight"});
  if (width && height) return set_size(description, *width, *height);
  if (!values.has_list({"image_size", "resolution", "img_size"})) return;
  const auto sides = values.numbers({"image_size", "resolution", "img_size"});
  if (sides.size() == kSides) set_size(description, sides[0], sides[1]);
}

void read_stated_unit(const CameraValues& values, CameraDescription& description) {
  const auto factor =
      values.number({"depth_scale", "png_depth_scale", "depth_unit_scale_factor", "depthmap_factor",
                     "DepthMapFactor", "depth_factor", "integer_depth_scale", "scale"});
  if (factor) set_depth_scale(description, *factor);
}

/// As a list, or as k1: ...; the order is that of OpenCV.
std::vector<double> stated_coefficients(const CameraValues& values, bool fisheye) {
  const auto lists = {"distortion_coefficients",
                      "Distortion_Coefficients",
                      "distortion_coeffs",
                      "dist_coeffs",
                      "distCoeffs",
                      "dist_coef",
                      "distortion",
                      "coeffs",
                      "dist",
                      "D",
                      "d"};
  for (const char* key : lists) {
    if (values.has_list({key})) return values.numbers({key});
  }
  std::vector<double> coefficients;
  const auto add = [&](std::initializer_list<const char*> keys) {
    for (const char* key : keys) coefficients.push_back(values.number({key}).value_or(0));
  };
  if (!values.has("k1")) return fisheye ? std::vector<double>(4, 0) : coefficients;
  if (fisheye) {
    add({"k1", "k2", "k3", "k4"});
  } else {
    add({"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"});
  }
  return coefficients;
}

void read_stated_distortion(const CameraValues& values, CameraDescription& description) {
  const std::string model = values.word({"distortion_model", "camera_model", "model"});
  const bool fisheye = model == "equidistant" || model == "fisheye" || model == "opencv_fisheye" ||
                       model.find("kannala") != std::string::npos;
  const auto coefficients = stated_coefficients(values, fisheye);
  const bool zero = std::all_of(coefficients.begin(), coefficients.end(), [](double k) { return k == 0; });
  if (model.find("inverse") != std::string::npos && !zero)
    values.document().reject(model,
                             fmt::format("the distortion model '{}', which kinloop does not have; undistort "
                                         "the images",
                                         model));
  set_distortion(description, coefficients, fisheye ? DistortionModel::kFisheye : DistortionModel::kOpenCv);
}

bool is_of_depth(const std::string& name) {
  const std::string small = lower_case(name);
  return small.find("depth") != std::string::npos || small.find("infra") != std::string::npos ||
         small.starts_with("ir");
}

using ReadLens = bool (*)(const CameraValues& values, CameraDescription& description);

/// The camera of an object in the document, with what the whole document states. Cameras of depth are used
/// only if there is no other.
std::optional<CameraDescription> camera_below(const CameraDocument& document, ReadLens read_lens) {
  const CameraValues root(document);
  std::vector<CameraDescription> color, depth;
  for (const CameraValues& values : root.with_objects_below()) {
    CameraDescription description = description_of(document);
    if (!read_lens(values, description)) continue;
    for (const CameraValues* from : {&root, &values}) {
      read_stated_size(*from, description);
      read_stated_unit(*from, description);
    }
    read_stated_distortion(values, description);
    if (const auto fps = values.number({"fps"})) set_fps(description, *fps);
    auto& cameras = is_of_depth(values.name()) ? depth : color;
    if (!cameras.empty() && !agree(cameras.front(), description))
      document.reject(values.name(), "cameras that differ; write a camera.yaml with one of them");
    if (cameras.empty()) cameras.push_back(description);
  }
  if (color.empty() && depth.empty()) return std::nullopt;
  return color.empty() ? depth.front() : color.front();
}

bool read_matrix_of(const CameraValues& values, CameraDescription& description) {
  constexpr size_t kFour = 4;
  for (const char* key :
       {"camera_matrix", "cameraMatrix", "Camera_Matrix", "intrinsic_matrix", "intrinsics_matrix",
        "intrinsic", "intrinsics", "cam_K", "cam_k", "K", "k", "mtx"}) {
    if (!values.has_list({key})) continue;
    const auto numbers = values.numbers({key});
    if (const auto k = intrinsics_of_matrix(numbers)) {
      set_intrinsics(description, k->fx, k->fy, k->cx, k->cy);
    } else if (numbers.size() == kFour) {
      set_intrinsics(description, numbers[0], numbers[1], numbers[2], numbers[3]);
    } else {
      values.document().reject(key, fmt::format("key '{}': not a matrix of intrinsics; correct it", key));
    }
    return true;
  }
  return false;
}

bool read_focal_lengths_of(const CameraValues& values, CameraDescription& description) {
  const auto fx = values.number({"fx", "fl_x", "f_x", "focal_x"});
  const auto cx = values.number({"cx", "ppx", "c_x", "principal_x"});
  if (!fx || !cx) return false;
  const double fy = values.required({"fy", "fl_y", "f_y", "focal_y"});
  const double cy = values.required({"cy", "ppy", "c_y", "principal_y"});
  set_intrinsics(description, *fx, fy, *cx, cy);
  return true;
}

}  // namespace

std::optional<CameraDescription> read_matrix_values(const CameraDocument& document) {
  return camera_below(document, read_matrix_of);
}

std::optional<CameraDescription> read_focal_lengths(const CameraDocument& document) {
  return camera_below(document, read_focal_lengths_of);
}

namespace {

/// fl_x, or the angle of view of instant-ngp. The centre of the top left pixel is (0.5, 0.5), as in COLMAP.
bool read_transforms_lens(const CameraValues& values, CameraDescription& description) {
  constexpr double kPixelCentre = 0.5;
  read_stated_size(values, description);
  const PinholeCamera& lens = description.camera.color;
  auto fx = values.number({"fl_x"});
  const auto angle_rad = values.number({"camera_angle_x"});
  if (!fx && angle_rad && description.has_size()) fx = 0.5 * lens.width / std::tan(0.5 * *angle_rad);
  if (!fx) return false;
  const auto centre = [&](std::string_view key, int side) {
    if (!description.has_size()) return values.required({key});
    return values.number({key}).value_or(0.5 * side);
  };
  set_intrinsics(description, *fx, values.number({"fl_y"}).value_or(*fx),
                 centre("cx", lens.width) - kPixelCentre, centre("cy", lens.height) - kPixelCentre);
  read_stated_distortion(values, description);
  return true;
}

}  // namespace

std::optional<CameraDescription> read_transforms(const CameraDocument& document) {
  const CameraValues root(document);
  const nlohmann::json* frames = root.find({"frames"});
  if (frames == nullptr || !frames->is_array()) return std::nullopt;
  CameraDescription description = description_of(document);
  read_stated_unit(root, description);
  if (read_transforms_lens(root, description)) return description;
  std::optional<CameraDescription> first;
  for (const nlohmann::json& frame : *frames) {
    CameraDescription of_frame = description;
    if (!read_transforms_lens(CameraValues(document, frame), of_frame)) continue;
    if (first && !agree(*first, of_frame))
      document.reject("frames", "the lens differs from frame to frame; write a camera.yaml with one camera");
    first = of_frame;
  }
  return first;
}

}  // namespace kinloop
