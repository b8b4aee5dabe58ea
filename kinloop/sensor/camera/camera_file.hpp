#pragma once
// In: camera.yaml. Out: RgbdCamera, and back.
//
//   width: 640
//   height: 480
//   fx: 517.306408
//   fy: 516.469215
//   cx: 318.643040
//   cy: 255.313989
//   distortion: [0.262383, -0.953104, -0.005358, 0.002628, 1.163314]  # k1 k2 p1 p2 k3
//   depth_scale: 5000        # units of the depth image per metre
//   fps: 30
//   model: brown_conrady     # optional, as all that follows; see below
//   rolling_shutter_s: 0.03
//   depth_offset_s: 0.015
//   depth_shift_m: -0.002    # to be added to every measured depth
//   sensor: kinect1          # a kind or a preset, see DepthSensorModel
//   depth: {width: 640, height: 480, fx: 585, fy: 585, cx: 320, cy: 240, distortion: [0, 0, 0, 0, 0]}
//   T_color_depth: {translation: [-0.024, 0.003, -0.005], rotation_vector: [-0.001, 0, 0.001]}
//
// Without `model` the lens is brown_conrady for 5 coefficients and rational for 8 (k4 k5 k6 follow);
// kannala_brandt has 4 (k1 k2 k3 k4), and none has no key `distortion`.
// `depth` is for depth that is not registered to colour; its width and height default to those of colour.

#include <filesystem>
#include <string>

#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// Reads camera.yaml. Throws InputError naming file, line, key and remedy if a key is unknown, missing,
/// duplicate or out of range.
RgbdCamera read_camera_file(const std::filesystem::path& path);

/// Same from the text of such a file, or JSON with the same keys; `path` is named in messages.
RgbdCamera read_camera_text(const std::string& text, const std::filesystem::path& path);

/// Returns the text of camera.yaml.
std::string camera_file_text(const RgbdCamera& camera);

/// Writes camera.yaml atomically; reading it back gives the same camera to the last bit, except for the
/// rotation of T_color_depth, which passes through a rotation vector.
void write_camera_file(const std::filesystem::path& path, const RgbdCamera& camera);

}  // namespace kinloop
