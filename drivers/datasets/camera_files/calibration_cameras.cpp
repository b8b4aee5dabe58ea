// Files of calibration programs: camodocal (VINS), Basalt, MATLAB and Agisoft Metashape.

#include <algorithm>

#include <fmt/format.h>

#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

std::vector<double> coefficients_of(const CameraValues& values, std::initializer_list<const char*> keys) {
  std::vector<double> coefficients;
  for (const char* key : keys) coefficients.push_back(values.number({key}).value_or(0));
  return coefficients;
}

void read_width_and_height(const CameraValues& values, CameraDescription& description) {
  const auto width = values.number({"image_width", "width"}),
             height = values.number({"image_height", "height"});
  if (width && height) set_size(description, *width, *height);
}

[[noreturn]] void reject_model(const CameraDocument& document, const std::string& key,
                               const std::string& model) {
  throw CameraPartError(
      fmt::format("{}: {} '{}' is a camera model that kinloop does not have; calibrate a "
                  "pinhole or Kannala-Brandt (equidistant) camera, or undistort the images",
                  document.file().string(), key, model));
}

}  // namespace

std::optional<CameraDescription> read_camodocal(const CameraDocument& document) {
  const CameraValues values(document);
  const std::string model = values.word({"model_type"});
  if (model.empty()) return std::nullopt;
  const auto projection = values.object_at({"projection_parameters"});
  if (!projection || (model != "pinhole" && model != "kannala_brandt"))
    reject_model(document, "model_type", model);
  CameraDescription description = description_of(document);
  read_width_and_height(values, description);
  if (model == "kannala_brandt") {
    set_intrinsics(description, projection->required({"mu"}), projection->required({"mv"}),
                   projection->required({"u0"}), projection->required({"v0"}));
    set_distortion(description, coefficients_of(*projection, {"k2", "k3", "k4", "k5"}),
                   DistortionModel::kFisheye);
  } else {
    set_intrinsics(description, projection->required({"fx"}), projection->required({"fy"}),
                   projection->required({"cx"}), projection->required({"cy"}));
    if (const auto distortion = values.object_at({"distortion_parameters"})) {
      set_distortion(description, coefficients_of(*distortion, {"k1", "k2", "p1", "p2", "k3"}));
      require_understood(document, distortion->object());
    }
  }
  require_understood(document, projection->object());
  require_understood(document, document.values());
  return description;
}

std::optional<CameraDescription> read_basalt(const CameraDocument& document) {
  const auto value = CameraValues(document).object_at({"value0"});
  const nlohmann::json* cameras = value ? value->find({"intrinsics"}) : nullptr;
  if (cameras == nullptr || !cameras->is_array() || cameras->empty()) return std::nullopt;
  const CameraValues camera(document, cameras->front());
  const std::string model = camera.word({"camera_type"});
  const auto lens = camera.object_at({"intrinsics"});
  if (!lens || (model != "pinhole" && model != "kb4" && model != "pinhole-radtan8"))
    reject_model(document, "camera_type", model);
  CameraDescription description = description_of(document);
  set_intrinsics(description, lens->required({"fx"}), lens->required({"fy"}), lens->required({"cx"}),
                 lens->required({"cy"}));
  if (model == "kb4")
    set_distortion(description, coefficients_of(*lens, {"k1", "k2", "k3", "k4"}), DistortionModel::kFisheye);
  if (model == "pinhole-radtan8")
    set_distortion(description, coefficients_of(*lens, {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}));
  constexpr size_t kSize = 2;
  const nlohmann::json* sizes = value->find({"resolution"});
  if (sizes != nullptr && sizes->is_array() && !sizes->empty()) {
    const nlohmann::json& size = sizes->front();
    if (size.is_array() && size.size() == kSize && size[0].is_number() && size[1].is_number())
      set_size(description, size[0].get<double>(), size[1].get<double>());
  }
  require_understood(document, lens->object());
  return description;
}

std::optional<CameraDescription> read_matlab(const CameraDocument& document) {
  constexpr size_t kPair = 2, kFewestRadial = 2, kMostRadial = 3;
  constexpr double kFirstPixel = 1;  // MATLAB counts pixels from 1
  for (const CameraValues& values : CameraValues(document).with_objects_below()) {
    const bool focal = values.has_list({"FocalLength"}) && values.has_list({"PrincipalPoint"});
    const bool matrix = values.has_list({"IntrinsicMatrix", "K"});
    if (!values.has("RadialDistortion") || (!focal && !matrix)) continue;
    CameraDescription description = description_of(document);
    if (matrix) {
      const auto k = intrinsics_of_matrix(values.numbers({"IntrinsicMatrix", "K"}));
      if (!k) document.reject("IntrinsicMatrix", "not a matrix of intrinsics; export the camera again");
      set_intrinsics(description, k->fx, k->fy, k->cx - kFirstPixel, k->cy - kFirstPixel);
    }
    const auto f = values.numbers({"FocalLength"}), c = values.numbers({"PrincipalPoint"});
    if (!matrix && f.size() == kPair && c.size() == kPair)
      set_intrinsics(description, f[0], f[1], c[0] - kFirstPixel, c[1] - kFirstPixel);
    const auto radial = values.numbers({"RadialDistortion"}),
               tangential = values.numbers({"TangentialDistortion"});
    if (radial.size() < kFewestRadial || radial.size() > kMostRadial ||
        (!tangential.empty() && tangential.size() != kPair))
      document.reject("RadialDistortion", "not two or three radial and two tangential coefficients");
    set_distortion(description, std::vector{radial[0], radial[1], tangential.empty() ? 0 : tangential[0],
                                            tangential.empty() ? 0 : tangential[1],
                                            radial.size() == kMostRadial ? radial[2] : 0});
    if (const auto size = values.numbers({"ImageSize"}); size.size() == kPair)
      set_size(description, size[1], size[0]);  // rows and columns
    if (description.camera.color.fx > 0) return description;
  }
  return std::nullopt;
}

/// The centre is relative to that of the image, and p1 and p2 are in the opposite order to OpenCV's (manual
/// of Metashape, appendix D).
std::optional<CameraDescription> read_agisoft(const CameraDocument& document) {
  const CameraValues values(document);
  if (!values.has("projection") || !values.has("f")) return std::nullopt;
  const std::string projection = values.word({"projection"});
  if (projection != "frame") reject_model(document, "projection", projection);
  constexpr double kHalf = 0.5;
  const double width = values.required({"width"}), height = values.required({"height"});
  const double f = values.required({"f"});
  CameraDescription description = description_of(document);
  set_size(description, width, height);
  set_intrinsics(description, f + values.number({"b1"}).value_or(0), f,
                 kHalf * width + values.number({"cx"}).value_or(0) - kHalf,
                 kHalf * height + values.number({"cy"}).value_or(0) - kHalf);
  set_distortion(description, coefficients_of(values, {"k1", "k2", "p2", "p1", "k3"}));
  require_understood(document, document.values());
  return description;
}

}  // namespace kinloop
