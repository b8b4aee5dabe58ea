#include "session/plan/sensor_memory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

constexpr const char* kReadoutKey = "rolling_shutter_s";
constexpr const char* kDelayKey = "depth_offset_s";

bool is_of_mode(const RememberedSensor& remembered, const RgbdCamera& camera) {
  return remembered.width == camera.color.width && remembered.height == camera.color.height &&
         remembered.fps == camera.fps;
}

std::optional<EstimatedTime> merged(std::optional<EstimatedTime> before, const SensorEstimate& estimate,
                                    SensorParameter parameter) {
  constexpr double kForgotten = 2;      // variance of what was known before, at each run
  constexpr double kMinSigma_s = 5e-4;  // errors of neighbouring keyframes are correlated
  if (!estimate.used.at(static_cast<size_t>(parameter))) return before;
  const EstimatedTime found{estimate.sensor.corrections(parameter),
                            std::max(estimate.sigma(parameter), kMinSigma_s)};
  if (!before) return found;
  const double weight_before = 1 / (kForgotten * before->sigma_s * before->sigma_s),
               weight = 1 / (found.sigma_s * found.sigma_s);
  return EstimatedTime{(weight_before * before->value_s + weight * found.value_s) / (weight_before + weight),
                       std::sqrt(1 / (weight_before + weight))};
}

/// Throws YAML::Exception unless it is a possible time, or absent.
std::optional<EstimatedTime> time_of(const YAML::Node& file, const char* key) {
  constexpr double kMaxTime_s = 1;
  const YAML::Node node = file[key];
  if (!node) return std::nullopt;
  const EstimatedTime time{node["value"].as<double>(), node["sigma"].as<double>()};
  if (!(std::abs(time.value_s) <= kMaxTime_s && time.sigma_s > 0 && time.sigma_s <= kMaxTime_s))
    throw YAML::Exception(node.Mark(), fmt::format("{}: impossible", key));
  return time;
}

std::string time_text(const char* key, const std::optional<EstimatedTime>& time) {
  return time ? fmt::format("{}: {{value: {:.6f}, sigma: {:.6f}}}\n", key, time->value_s, time->sigma_s) : "";
}

std::string text_of(const RememberedSensor& remembered) {
  return fmt::format(
             "# What kinloop estimated of this camera in earlier runs: seconds, 1 sigma. May be deleted.\n"
             "width: {}\nheight: {}\nfps: {}\nruns: {}\n",
             remembered.width, remembered.height, remembered.fps, remembered.runs) +
         time_text(kReadoutKey, remembered.rolling_shutter) + time_text(kDelayKey, remembered.depth_delay);
}

std::string file_name(std::string serial) {
  const auto allowed = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
  };
  std::replace_if(serial.begin(), serial.end(), std::not_fn(allowed), '_');
  return serial + ".yaml";
}

std::string in_words(const std::optional<EstimatedTime>& time, const char* what) {
  if (!time) return "";
  return fmt::format(", {} {:.1f} +- {:.1f} ms", what, 1e3 * time->value_s, 1e3 * time->sigma_s);
}

}  // namespace

std::optional<RememberedSensor> merged(const RememberedSensor& before, const RgbdCamera& camera,
                                       const SensorEstimate& estimate) {
  if (!estimate.used[kRollingShutter] && !estimate.used[kDepthDelay]) return std::nullopt;
  RememberedSensor after = before;
  if (!is_of_mode(before, camera)) after = {camera.color.width, camera.color.height, camera.fps, 0, {}, {}};
  after.rolling_shutter = merged(after.rolling_shutter, estimate, kRollingShutter);
  after.depth_delay = merged(after.depth_delay, estimate, kDepthDelay);
  ++after.runs;
  return after;
}

std::filesystem::path sensor_memory_folder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing sets it
    return std::filesystem::path(value != nullptr ? value : "");
  };
  const auto under = [](const std::filesystem::path& data) { return data / "kinloop" / "sensors"; };
  // A relative path is to be ignored (XDG Base Directory Specification).
  if (const auto data = variable("XDG_DATA_HOME"); data.is_absolute()) return under(data);
  if (const auto home = variable("HOME"); home.is_absolute()) return under(home / ".local" / "share");
  return {};
}

SensorMemory::SensorMemory(const std::filesystem::path& folder, const std::string& serial)
    : serial_(serial), file_(folder / file_name(serial)) {}

RememberedSensor SensorMemory::read() const {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file_, ignored)) return {};
  try {
    const YAML::Node file = YAML::LoadFile(file_.string());
    return {file["width"].as<int>(), file["height"].as<int>(),   file["fps"].as<double>(),
            file["runs"].as<int>(),  time_of(file, kReadoutKey), time_of(file, kDelayKey)};
  } catch (const YAML::Exception& error) {
    log::warn("{}: cannot be read, and is ignored ({})", file_.string(), error.what());
    return {};
  }
}

RgbdCamera SensorMemory::recall(RgbdCamera camera) const {
  const RememberedSensor remembered = read();
  if (!is_of_mode(remembered, camera)) return camera;
  std::optional<EstimatedTime> readout, delay;
  if (!camera.rolling_shutter_s) readout = remembered.rolling_shutter;
  if (camera.depth_delay_s == 0) delay = remembered.depth_delay;
  if (!readout && !delay) return camera;
  if (readout) camera.rolling_shutter_s = std::max(readout->value_s, 0.0);
  if (delay) camera.depth_delay_s = delay->value_s;
  log::info("camera {}: as {} earlier run{} estimated{}{} ({}; --no-remember ignores it)", serial_,
            remembered.runs, remembered.runs == 1 ? "" : "s", in_words(readout, "readout time"),
            in_words(delay, "depth delay"), file_.string());
  return camera;
}

void SensorMemory::remember(const RgbdCamera& camera, const SensorEstimate& estimate) const {
  const auto after = merged(read(), camera, estimate);
  if (!after) return;
  try {
    std::filesystem::create_directories(file_.parent_path());
    write_file(file_, text_of(*after));
    log::info("camera {}: remembered{}{} ({})", serial_, in_words(after->rolling_shutter, "readout time"),
              in_words(after->depth_delay, "depth delay"), file_.string());
  } catch (const std::exception& error) {
    log::warn("camera {}: its times cannot be remembered ({})", serial_, error.what());
  }
}

std::optional<SensorMemory> sensor_memory_of(const SourceInfo& info) {
  const auto folder = sensor_memory_folder();
  // Some Kinects 1 have none but zeros.
  const bool known = info.serial.find_first_not_of('0') != std::string::npos;
  if (!info.live || !known || folder.empty()) return std::nullopt;
  return SensorMemory(folder, info.serial);
}

}  // namespace kinloop
