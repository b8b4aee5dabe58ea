// A camera file is used whole or not at all: what is not understood and would change the result is an error.

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "kinloop/core/text/lower_case.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

bool has_part(const std::string& text, std::initializer_list<const char*> parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](const char* part) { return text.find(part) != std::string::npos; });
}

/// Small letters and digits only: "distCoeffs" and "dist_coeffs" are one key.
std::string plain(const std::string& key) {
  std::string text = lower_case(key);
  std::erase_if(text, [](char c) { return c == '_' || c == '-' || c == ' ' || c == '.'; });
  return text;
}

/// What a key looks like, for users; empty: something else.
const char* meaning_of(const std::string& key) {
  constexpr std::array kCoefficients = {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2", "p3",
                                        "p4", "s1", "s2", "s3", "s4", "xi", "b1", "b2", "skew"};
  const std::string name = plain(key);
  // Of an IMU, a body, a stereo partner or rectification, which mapping with one camera does not use.
  if (has_part(name, {"imu",
                      "body",
                      "tbc",
                      "bc1",
                      "bc2",
                      "stereo",
                      "rectif",
                      "undist",
                      "distance",
                      "cncnm",
                      "timeshift",
                      "localtransform",
                      "noise",
                      "sensor",
                      "board",
                      "square",
                      "pixel",
                      "new",
                      "baseline",
                      "bf",
                      "extrinsicrotation",
                      "extrinsictranslation",
                      "extrinsicparameters",
                      "estimate"}))
    return "";
  if (has_part(name, {"distort", "distcoef", "radial", "tangential", "coeff"}) || name == "dist" ||
      name == "disto" || std::find(kCoefficients.begin(), kCoefficients.end(), name) != kCoefficients.end())
    return "distortion";
  const bool of_depth = name.find("depth") != std::string::npos;
  if (has_part(name, {"extrinsic", "tcolordepth", "tdepthcolor", "depthtocolor", "depth2color", "depthtorgb",
                      "depth2rgb", "rgbtodepth", "colortodepth"}) ||
      name == "rotation" || name == "translation" ||
      (of_depth && has_part(name, {"rotation", "translation", "transform", "pose"})))
    return "a transformation between cameras";
  if (of_depth && has_part(name, {"unit", "scal", "factor", "shift", "offset"})) return "a unit of depth";
  if (has_part(name, {"imagesize", "imgsize", "imagewidth", "imageheight", "imgwidth", "imgheight",
                      "resolution", "imageshape", "binning"}) ||
      name == "width" || name == "height" || name == "xoffset" || name == "yoffset")
    return "a size of images";
  return "";
}

/// Whether a value says nothing: no distortion, no motion, no binning.
bool is_neutral(const json& value) {
  if (value.is_null() || value.is_boolean()) return true;
  if (value.is_number()) return value.get<double>() == 0 || value.get<double>() == 1;
  if (value.is_string()) {
    const std::string text = lower_case(value.get<std::string>());
    return text.empty() || text == "none" || text == "0";
  }
  return std::all_of(value.begin(), value.end(), [](const json& element) { return is_neutral(element); });
}

bool holds_used(const CameraDocument& document, const json& value) {
  if (document.is_used(value)) return true;
  return value.is_structured() && std::any_of(value.begin(), value.end(), [&](const json& element) {
           return holds_used(document, element);
         });
}

/// Whether this is the "roi" of ROS with an offset.
bool is_cut_out(const std::string& key, const json& value) {
  if (key != "roi" || !value.is_object()) return false;
  const auto is_offset = [&](const char* side) { return value.contains(side) && !is_neutral(value[side]); };
  return is_offset("x_offset") || is_offset("y_offset");
}

}  // namespace

void require_understood(const CameraDocument& document, const json& object) {
  if (!object.is_object() || object.contains("data")) return;  // "rows" and "cols" of a matrix
  for (const auto& [key, value] : object.items()) {
    if (is_neutral(value) || holds_used(document, value)) continue;
    const std::string meaning = is_cut_out(key, value) ? "a part of a larger image" : meaning_of(key);
    if (meaning.empty()) continue;
    try {
      document.reject(key,
                      fmt::format("key '{}' looks like {} and is not understood; write a camera.yaml, or "
                                  "remove the key if it does not matter",
                                  key, meaning));
    } catch (const InputError& error) {
      throw CameraPartError(error.what());
    }
  }
}

}  // namespace kinloop
