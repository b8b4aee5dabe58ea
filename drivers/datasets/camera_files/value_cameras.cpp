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
  for (const char* key : {"image_size", "resolution", "img_size", "imageSize", "size"}) {
    if (values.has_list({key})) {
      const auto sides = values.numbers({key});
      if (sides.size() == kSides) set_size(description, sides[0], sides[1]);
    } else if (const auto inner = values.object_at({key})) {
      const auto inner_width = inner->number({"width", "x"}), inner_height = inner->number({"height", "y"});
      if (inner_width && inner_height) set_size(description, *inner_width, *inner_height);
    }
  }
}

/// BOP's depth_scale is in millimetres per unit. As metres per unit, or units per metre, these values would
/// be impossible; 1 alone may have been meant otherwise.
bool is_in_millimetres(const CameraValues& values, double depth_scale) {
  constexpr double kFinest_mm = 0.02, kCoarsest_mm = 10;
  const bool possible = depth_scale >= kFinest_mm && depth_scale <= kCoarsest_mm;
  return possible && (depth_scale != 1 || values.has("cam_K"));
}

void read_stated_unit(const CameraValues& values, CameraDescription& description) {
  constexpr double kMillimetres = 1000;
  if (const auto scale = values.number({"depth_scale"}); scale && is_in_millimetres(values, *scale))
    return set_depth_scale(description, kMillimetres / *scale);
  const auto factor =
      values.number({"depth_scale", "png_depth_scale", "depth_unit_scale_factor", "depthmap_factor",
                     "DepthMapFactor", "depth_factor", "integer_depth_scale", "scale"});
  if (factor) set_depth_scale(description, *factor);
}

/// k1, k2 ... as keys of their own; empty if there is none.
std::vector<double> named_coefficients(const CameraValues& values, bool fisheye) {
  std::vector<double> coefficients;
  const auto add = [&](std::initializer_list<const char*> keys) {
    for (const char* key : keys) coefficients.push_back(values.number({key}).value_or(0));
  };
  if (!values.has("k1")) return coefficients;
  if (fisheye) {
    add({"k1", "k2", "k3", "k4"});
  } else {
    add({"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"});
  }
  return coefficients;
}

/// {radial: [k1, k2, k3], tangential: [p1, p2]}; empty if there is none.
std::vector<double> radial_and_tangential(const CameraValues& values) {
  constexpr size_t kTwo = 2, kThree = 3;
  const auto radial = values.numbers({"radial", "radial_distortion"});
  const auto tangential = values.numbers({"tangential", "tangential_distortion"});
  if (radial.empty() && tangential.empty()) return {};
  if (radial.size() < kTwo || radial.size() > kThree || (!tangential.empty() && tangential.size() != kTwo))
    values.document().reject("radial", "not two or three radial and two tangential coefficients; correct it");
  return {radial[0], radial[1], tangential.empty() ? 0 : tangential[0],
          tangential.empty() ? 0 : tangential[1], radial.size() == kThree ? radial[2] : 0};
}

constexpr std::initializer_list<const char*> kDistortionKeys = {"distortion_coefficients",
                                                                "Distortion_Coefficients",
                                                                "distortion_coeffs",
                                                                "distortion_parameters",
                                                                "dist_coeffs",
                                                                "distCoeffs",
                                                                "dist_coef",
                                                                "distortion",
                                                                "distortion_params",
                                                                "coeffs",
                                                                "dist",
                                                                "disto",
                                                                "D",
                                                                "d"};

/// As a list, as k1: ..., or in an object of its own; the order is that of OpenCV. Empty if there is none.
std::vector<double> stated_coefficients(const CameraValues& values, bool fisheye) {
  for (const char* key : kDistortionKeys) {
    if (values.has_list({key})) return values.numbers({key});
  }
  if (auto named = named_coefficients(values, fisheye); !named.empty()) return named;
  if (values.has_list({"radial"}) || values.has_list({"radial_distortion"}))
    return radial_and_tangential(values);
  for (const char* key : kDistortionKeys) {
    const auto inner = values.object_at({key});
    if (!inner) continue;
    auto named = named_coefficients(*inner, fisheye);
    if (named.empty()) named = radial_and_tangential(*inner);
    require_understood(values.document(), inner->object());
    if (!named.empty()) return named;
  }
  return {};
}

bool is_fisheye(const std::string& model) {
  return model == "equidistant" || model == "fisheye" || model == "opencv_fisheye" ||
         model.find("kannala") != std::string::npos;
}

/// true, or the 1 of OpenCV's files.
bool is_flag_set(const CameraValues& values, const char* key) {
  const nlohmann::json* flag = values.find({key});
  if (flag == nullptr) return false;
  return flag->is_boolean() ? flag->get<bool>() : flag->is_number() && flag->get<double>() != 0;
}

/// Whether a word names a lens that is not pinhole with OpenCV's coefficients, and not fisheye.
bool is_unknown_model(const std::string& model) {
  for (const char* unknown : {"omni", "mei", "fov", "scaramuzza", "double_sphere", "eucm", "division", "atan",
                              "thin_prism", "ftheta", "inverse"}) {
    if (model.find(unknown) != std::string::npos) return true;
  }
  return false;
}

void read_stated_distortion(const CameraValues& values, CameraDescription& description) {
  std::string model = values.word({"distortion_model", "camera_model", "model"});
  if (const auto inner = values.object_at({"distortion"}); inner && model.empty())
    model = inner->word({"model", "type", "distortion_model"});
  const bool fisheye =
      is_fisheye(model) || is_flag_set(values, "is_fisheye") || is_flag_set(values, "fisheye_model");
  auto coefficients = stated_coefficients(values, fisheye);
  const bool zero = std::all_of(coefficients.begin(), coefficients.end(), [](double k) { return k == 0; });
  if (is_unknown_model(model) && !zero)
    values.document().reject(model,
                             fmt::format("the distortion model '{}', which kinloop does not have; undistort "
                                         "the images",
                                         model));
  if (fisheye && coefficients.empty()) coefficients.assign(4, 0);
  set_distortion(description, coefficients, fisheye ? DistortionModel::kFisheye : DistortionModel::kOpenCv);
}

/// Of depth, or of the right camera of a stereo pair, to which depth is not registered.
bool is_of_another(const std::string& name) {
  const std::string small = lower_case(name);
  return small.find("depth") != std::string::npos || small.starts_with("right") ||
         small.find("infra") != std::string::npos || small.starts_with("ir");
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
    if (!description.camera.color.has_distortion()) read_stated_distortion(root, description);
    if (const auto fps = values.number({"fps"})) set_fps(description, *fps);
    const bool of_depth = is_of_another(values.name());
    if (!of_depth) require_understood(document, values.object());
    auto& cameras = of_depth ? depth : color;
    if (!cameras.empty() && !agree(cameras.front(), description))
      document.reject(values.name(), "cameras that differ; write a camera.yaml with one of them");
    if (cameras.empty()) cameras.push_back(description);
  }
  if (color.empty() && depth.empty()) return std::nullopt;
  require_understood(document, document.values());
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
  if (read_transforms_lens(root, description)) {
    require_understood(document, document.values());
    return description;
  }
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
