#include "apps/shared/command_line/common_options.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kinloop/core/text/did_you_mean.hpp"

namespace kinloop {
namespace {

template <class Number>
CLI::Validator in_range(Number low, Number high, const char* kind) {
  const auto check = [=](const std::string& text) -> std::string {
    Number value = 0;
    if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return {};
    return fmt::format("'{}' is not {} from {} to {}", text, kind, low, high);
  };
  return {check, fmt::format("from {} to {}", low, high)};
}

}  // namespace

void add_map_argument(CLI::App& command, std::filesystem::path& map) {
  command.add_option("MAP", map, "a map file, or the folder of a run")->required();
}

void add_poses_option(CLI::App& command, std::filesystem::path& poses) {
  command.add_option("--poses", poses, "read the image poses from this file (TUM format) instead of the map");
}

void add_set_option(CLI::App& command, std::vector<std::string>& assignments, const std::string& what) {
  command.add_option("--set", assignments, what + "; may be repeated")
      ->allow_extra_args(false)
      ->option_text("KEY=VALUE");
}

void add_frame_option(CLI::App& command, std::string& frame) {
  command
      .add_option("--frame", frame,
                  "axes of the cloud or mesh: z-up, or camera: those of the first camera (y down), as in\n"
                  "the trajectory")
      ->check(one_of({"z-up", "camera"}))
      ->capture_default_str();
}

void add_up_option(CLI::App& command, std::vector<std::string>& assignments) {
  const auto assign = [&assignments](const std::vector<double>& up) {
    if (std::all_of(up.begin(), up.end(), [](double value) { return value == 0; }))
      throw CLI::ValidationError("--up", "0,0,0 is no direction; e.g. 0,-1,0 for a level camera");
    constexpr const char* kAxes[] = {"x", "y", "z"};
    for (size_t i = 0; i < up.size(); ++i)
      assignments.push_back(fmt::format("dense.up_{}={}", kAxes[i], up[i]));
  };
  command
      .add_option_function<std::vector<double>>(
          "--up", assign,
          "up direction in the axes of the first camera: x right, y down, z forward. 0,-1,0: held level;\n"
          "-1,0,0 and 1,0,0: turned by 90 degrees; 0,1,0: upside down (default: estimated from surfaces)")
      ->delimiter(',')
      ->expected(3)
      ->option_text("X,Y,Z");
}

void add_camera_options(CLI::App& command, CameraOptions& camera) {
  constexpr double kFewestUnits = 1, kMostUnits = 1e5;  // as in camera.yaml
  CLI::Option* file = command.add_option(
      "--camera", camera.camera,
      "camera.yaml, a camera file of OpenCV, ROS, ORB-SLAM, Kalibr, COLMAP, Open3D, ... (see\n"
      "docs/recordings.md), or one of freiburg1, freiburg2, freiburg3, icl (default: that of the\n"
      "recording, else a camera file in the folder or the one above)");
  file->option_text("FILE");
  command
      .add_option("--intrinsics", camera.intrinsics,
                  "the camera as fx,fy,cx,cy[,k1,k2,p1,p2,k3], in pixels, for a folder of images")
      ->option_text("fx,fy,cx,cy")
      ->excludes(file);
  command
      .add_option(
          "--depth-scale", camera.depth_scale,
          "units of the depth images of a folder or bag per metre, 1000 for millimetres (default: as the\n"
          "camera file or the dataset has it, else guessed)")
      ->option_text("UNITS_PER_M")
      ->check(number(kFewestUnits, kMostUnits));
  command
      .add_option(
          "--sensor", camera.sensor,
          "the depth sensor, whose noise and range are used (default: that of the camera file or the\n"
          "recording, else kinect1)")
      ->option_text("NAME")
      ->check(one_of(names_of<DepthSensorModel>()));
}

void add_sequence_option(CLI::App& command, std::string& chosen) {
  command
      .add_option("--sequence", chosen,
                  "which sequence of a folder that contains several, by its path in that folder; without it\n"
                  "they are listed")
      ->option_text("NAME");
}

CLI::Validator whole_number(int low, int high) {
  return in_range(low, high, "a whole number");
}

CLI::Validator number(double low, double high) {
  return in_range(low, high, "a number");
}

CLI::Validator one_of(std::vector<std::string> words) {
  const std::string list = fmt::format("{}", fmt::join(words, ", "));
  const auto check = [words = std::move(words), list](const std::string& text) -> std::string {
    if (std::find(words.begin(), words.end(), text) != words.end()) return {};
    return fmt::format("'{}' is not one of {}{}", text, list, did_you_mean(text, words));
  };
  return {check, list};
}

void add_threads_option(CLI::App& command, int& threads, const std::string& what) {
  constexpr int kMaxThreads = 1024;
  command.add_option("--threads", threads, what)->check(whole_number(1, kMaxThreads));
}

CLI::Validator positive_number() {
  const auto check = [](const std::string& text) -> std::string {
    double value = 0;
    if (CLI::detail::lexical_cast(text, value) && value > 0 && std::isfinite(value)) return {};
    return fmt::format("'{}' must be a positive number", text);
  };
  return {check, "POSITIVE"};
}

void add_quiet_option(CLI::App& command, bool& quiet) {
  command.add_flag("-q,--quiet", quiet, "print only warnings and errors");
}

}  // namespace kinloop
