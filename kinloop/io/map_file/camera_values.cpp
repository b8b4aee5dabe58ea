#include "kinloop/io/map_file/camera_values.hpp"

#include <algorithm>
#include <stdexcept>

#include "kinloop/sensor/camera/possible_camera.hpp"

namespace kinloop {
namespace {

using NamedValues = std::vector<std::pair<std::string, double>>;

void add_lens(NamedValues& values, const std::string& prefix, const PinholeCamera& c) {
  const auto add = [&](const char* name, double value) { values.emplace_back(prefix + name, value); };
  add("width", c.width), add("height", c.height);
  add("fx", c.fx), add("fy", c.fy), add("cx", c.cx), add("cy", c.cy);
  const LensDistortion& d = c.lens;
  add("k1", d.k1), add("k2", d.k2), add("p1", d.p1), add("p2", d.p2), add("k3", d.k3);
  if (d.model == LensModel::kBrownConrady) return;
  add("lens_model", static_cast<double>(d.model));
  add("k4", d.k4), add("k5", d.k5), add("k6", d.k6);
}

template <NamedEnum Enum>
Enum enum_from(double number) {
  constexpr auto kValues = option_names(Enum{});
  const auto value = std::find_if(kValues.begin(), kValues.end(), [&](const auto& known) {
    return static_cast<double>(known.value) == number;
  });
  if (value == kValues.end()) throw std::out_of_range("not a value of the enum");
  return value->value;
}

int side_from(double pixels) {
  constexpr double kMaxSide_px = 1 << 15;
  return pixels >= 1 && pixels <= kMaxSide_px ? static_cast<int>(pixels) : 0;
}

PinholeCamera lens_from(const std::map<std::string, double>& values, const std::string& prefix) {
  const auto at = [&](const char* name) { return values.at(prefix + name); };
  PinholeCamera c;
  c.width = side_from(at("width")), c.height = side_from(at("height"));
  c.fx = at("fx"), c.fy = at("fy"), c.cx = at("cx"), c.cy = at("cy");
  LensDistortion& d = c.lens;
  d.k1 = at("k1"), d.k2 = at("k2"), d.p1 = at("p1"), d.p2 = at("p2"), d.k3 = at("k3");
  if (!values.contains(prefix + "lens_model")) return c;  // Brown-Conrady, and all older files
  d.model = enum_from<LensModel>(at("lens_model"));
  d.k4 = at("k4"), d.k5 = at("k5"), d.k6 = at("k6");
  return c;
}

void add_depth_lens(const std::map<std::string, double>& values, RgbdCamera& camera) {
  camera.depth = lens_from(values, "depth.");
  const auto at = [&](const char* name) { return values.at(std::string("T_color_depth.") + name); };
  camera.T_color_depth = {Eigen::Quaterniond(at("qw"), at("qx"), at("qy"), at("qz")),
                          {at("x"), at("y"), at("z")}};
}

}  // namespace

NamedValues camera_values(const RgbdCamera& camera) {
  NamedValues values;
  add_lens(values, "", camera.color);
  const auto add = [&](const char* name, double value) { values.emplace_back(name, value); };
  add("depth_scale", camera.depth_scale), add("fps", camera.fps);
  if (camera.rolling_shutter_s) add("rolling_shutter_s", *camera.rolling_shutter_s);
  add("depth_offset_s", camera.depth_delay_s);
  if (camera.sensor.origin != SensorOrigin::kAssumed)
    add("depth_sensor", static_cast<double>(camera.sensor.model));
  if (!camera.depth) return values;
  add_lens(values, "depth.", *camera.depth);
  const auto& [q, t] = camera.T_color_depth;
  add("T_color_depth.x", t.x()), add("T_color_depth.y", t.y()), add("T_color_depth.z", t.z());
  add("T_color_depth.qx", q.x()), add("T_color_depth.qy", q.y()), add("T_color_depth.qz", q.z());
  add("T_color_depth.qw", q.w());
  return values;
}

std::optional<RgbdCamera> camera_from(const std::map<std::string, double>& values) try {
  RgbdCamera camera;
  camera.color = lens_from(values, "");
  camera.depth_scale = values.at("depth_scale");
  camera.fps = values.at("fps");
  if (values.contains("rolling_shutter_s")) camera.rolling_shutter_s = values.at("rolling_shutter_s");
  camera.depth_delay_s = values.at("depth_offset_s");
  if (values.contains("depth_sensor"))  // not in older files
    camera.sensor =
        depth_sensor(enum_from<DepthSensorModel>(values.at("depth_sensor")), SensorOrigin::kSource);
  if (values.contains("depth.fx")) add_depth_lens(values, camera);
  if (!is_possible(camera)) return std::nullopt;
  return camera;
} catch (const std::out_of_range&) {
  return std::nullopt;
}

}  // namespace kinloop
