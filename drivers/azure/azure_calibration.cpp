#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "drivers/azure/azure_recording.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

using Json = nlohmann::json;

/// How an image is made from the calibrated one: scaled, then cropped.
struct SensorMode {
  cv::Size image, scaled;
  cv::Point crop;
};

/// Of the depth sensor, whose calibration is for 1024 x 1024 (Azure Kinect Sensor SDK).
const std::vector<SensorMode> kDepthModes = {{{320, 288}, {512, 512}, {96, 90}},
                                             {{640, 576}, {1024, 1024}, {192, 180}},
                                             {{512, 512}, {512, 512}, {0, 0}},
                                             {{1024, 1024}, {1024, 1024}, {0, 0}}};

SensorMode depth_mode(cv::Size size) {
  for (const SensorMode& mode : kDepthModes) {
    if (mode.image == size) return mode;
  }
  throw InputError(fmt::format("depth of {} x {} pixels is no mode of the sensor", size.width, size.height));
}

/// Colour has the whole sensor (4:3), or is cropped at top and bottom (16:9).
SensorMode color_mode(cv::Size size) {
  const cv::Size whole(size.width, size.width * 3 / 4);
  if (size.width <= 0 || size.height <= 0 || size.height > whole.height)
    throw InputError(
        fmt::format("colour of {} x {} pixels is no mode of the sensor", size.width, size.height));
  return {size, whole, {0, (whole.height - size.height) / 2}};
}

const Json& camera_at(const Json& calibration, const std::string& location) {
  for (const Json& camera : calibration.at("CalibrationInformation").at("Cameras")) {
    if (camera.at("Location") == location) return camera;
  }
  throw InputError(fmt::format("calibration.json has no camera {}", location));
}

PinholeCamera camera_in_mode(const Json& json, const SensorMode& mode) {
  constexpr size_t kParameters = 14;  // cx cy fx fy k1 to k6, 2 unused, p2 p1
  const Json& intrinsics = json.at("Intrinsics");
  const auto p = intrinsics.at("ModelParameters").get<std::vector<double>>();
  const auto model = intrinsics.at("ModelType").get<std::string>();
  if (p.size() != kParameters || !model.ends_with("BrownConrady"))
    throw InputError("calibration.json has a lens model other than BrownConrady with 14 parameters");
  PinholeCamera c;
  c.width = mode.image.width, c.height = mode.image.height;
  // Relative to the size of the sensor, from the corner of the first pixel; ours are from its centre.
  c.cx = p[0] * mode.scaled.width - mode.crop.x - 0.5;
  c.cy = p[1] * mode.scaled.height - mode.crop.y - 0.5;
  c.fx = p[2] * mode.scaled.width;
  c.fy = p[3] * mode.scaled.height;
  c.lens = {LensModel::kRational, p[4], p[5], p[13], p[12], p[6], p[7], p[8], p[9]};
  const double focal_share = c.fx / mode.scaled.width;
  constexpr double kMinShare = 0.1, kMaxShare = 10;
  if (!(focal_share > kMinShare && focal_share < kMaxShare) || !(c.fy > 0) || !std::isfinite(c.cx + c.cy))
    throw InputError("calibration.json has impossible intrinsics");
  return c;
}

/// p_camera = T * p_rig.
SE3 pose_of(const Json& camera) {
  const auto r = camera.at("Rt").at("Rotation").get<std::vector<double>>();
  const auto t = camera.at("Rt").at("Translation").get<std::vector<double>>();
  if (r.size() != 9 || t.size() != 3) throw InputError("calibration.json has no pose of 9 and 3 numbers");
  const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r.data());
  SE3 pose{Eigen::Quaterniond(R), Eigen::Vector3d(t[0], t[1], t[2])};
  pose.rotation.normalize();
  constexpr double kTolerance = 1e-3;
  if (!pose.is_finite() || !((pose.R() - R).norm() < kTolerance))
    throw InputError("calibration.json has a pose that is not a rigid motion");
  return pose;
}

/// The SDK ends the text with NUL.
std::string_view without_trailing_nul(std::string_view text) {
  while (text.ends_with('\0')) text.remove_suffix(1);
  return text;
}

}  // namespace

AzureCalibration read_azure_calibration(const std::string& text, cv::Size color, cv::Size depth) {
  try {
    const Json json = Json::parse(without_trailing_nul(text));
    const Json& color_json = camera_at(json, "CALIBRATION_CameraLocationPV0");
    const Json& depth_json = camera_at(json, "CALIBRATION_CameraLocationD0");
    AzureCalibration calibration;
    calibration.color = camera_in_mode(color_json, color_mode(color));
    calibration.depth = camera_in_mode(depth_json, depth_mode(depth));
    calibration.T_color_depth = pose_of(color_json) * pose_of(depth_json).inverse();
    return calibration;
  } catch (const Json::exception&) {
    throw InputError("calibration.json is not the calibration of an Azure Kinect");
  }
}

}  // namespace kinloop
