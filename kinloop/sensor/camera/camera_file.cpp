#include "kinloop/sensor/camera/camera_file.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/options.hpp"

namespace kinloop {
namespace {

/// yaml-cpp counts lines from 0.
size_t line_of(const YAML::Mark& mark) {
  return mark.is_null() ? 1 : static_cast<size_t>(mark.line) + 1;
}

/// One block "key: value" of the file; errors name file, line and key.
class Block {
 public:
  /// `prefix` names the block in messages, e.g. "depth.".
  Block(const std::filesystem::path& path, std::string prefix, const YAML::Node& node,
        const std::vector<std::string>& known_keys)
      : path_(path), prefix_(std::move(prefix)), node_(node) {
    if (!node_.IsMap()) fail(node_, fmt::format("expected keys {}", fmt::join(known_keys, ", ")));
    for (const auto& entry : node_) {
      const YAML::Node& key_node = entry.first;
      const auto key = key_node.as<std::string>("");
      if (std::find(known_keys.begin(), known_keys.end(), key) == known_keys.end()) {
        fail(key_node, fmt::format("unknown key '{}{}'; expected one of {}", prefix_, key,
                                   fmt::join(known_keys, ", ")));
      }
      if (!lines_.emplace(key, line_of(key_node.Mark())).second) {
        fail(key_node, fmt::format("key '{}{}' is given twice; keep one", prefix_, key));
      }
    }
  }

  [[nodiscard]] bool has(const std::string& key) const { return node_[key].IsDefined(); }

  [[nodiscard]] YAML::Node at(const std::string& key, const std::string& example) const {
    if (!has(key)) {
      fail(node_, fmt::format("key '{}{}' is missing; add it, e.g. {}: {}", prefix_, key, key, example));
    }
    return node_[key];
  }

  [[nodiscard]] double number(const std::string& key, const std::string& example, Range range) const {
    return to_number(at(key, example), key, number_in(range), range);
  }

  [[nodiscard]] double number_or_zero(const std::string& key, const std::string& unit, Range range) const {
    if (!has(key)) return 0;
    return to_number(node_[key], key, fmt::format("{}, in {}", number_in(range), unit), range);
  }

  [[nodiscard]] int size_px(const std::string& key, const std::string& example) const {
    constexpr int kMaxSize_px = 30'000;
    const YAML::Node value = at(key, example);
    const std::string expected =
        fmt::format("a whole number of pixels from 1 to {}, e.g. {}", kMaxSize_px, example);
    int size = 0;
    if (!value.IsScalar() || !YAML::convert<int>::decode(value, size) || size <= 0 || size > kMaxSize_px) {
      reject(value, key, expected);
    }
    return size;
  }

  /// A list with one of the `counts`.
  [[nodiscard]] std::vector<double> numbers(const std::string& key, const std::vector<size_t>& counts,
                                            const std::string& example, Range range) const {
    const YAML::Node list = at(key, example);
    const std::string expected = fmt::format("a list of {} numbers from {} to {}, e.g. {}",
                                             fmt::join(counts, " or "), range.low, range.high, example);
    if (!list.IsSequence() || std::find(counts.begin(), counts.end(), list.size()) == counts.end())
      reject(list, key, expected);
    std::vector<double> values;
    for (const YAML::Node& number : list) values.push_back(to_number(number, key, expected, range));
    return values;
  }

  [[nodiscard]] Eigen::Vector3d vector3(const std::string& key, Range range) const {
    return Eigen::Vector3d(numbers(key, {3}, "[0, 0, 0]", range).data());
  }

  /// One of the `names`.
  [[nodiscard]] std::string name(const std::string& key, const std::vector<std::string>& names) const {
    const YAML::Node value = at(key, names.front());
    auto text = value.as<std::string>("");
    if (std::find(names.begin(), names.end(), text) == names.end())
      reject(value, key, fmt::format("one of {}", fmt::join(names, ", ")));
    return text;
  }

  /// Like `number`, for a value per metre: one below `range` that fits as metres each is told apart.
  [[nodiscard]] double number_per_metre(const std::string& key, const std::string& example,
                                        Range range) const {
    const YAML::Node value = at(key, example);
    double number = 0;
    const bool is_number = value.IsScalar() && YAML::convert<double>::decode(value, number);
    if (is_number && number > 0 && number < range.low && 1 / number <= range.high) {
      reject(value, key,
             fmt::format("in units per metre: {:g} metres a unit are {}: {:g}", number, key, 1 / number));
    }
    return to_number(value, key, number_in(range), range);
  }

  /// Rejects a key that contradicts others.
  void refuse(const std::string& key, const std::string& why) const {
    if (has(key)) throw_parse_error(path_, lines_.at(key), fmt::format("key '{}{}': {}", prefix_, key, why));
  }

 private:
  [[noreturn]] void fail(const YAML::Node& node, const std::string& what) const {
    throw_parse_error(path_, line_of(node.Mark()), what);
  }
  [[noreturn]] void reject(const YAML::Node& value, const std::string& key,
                           const std::string& expected) const {
    // Line of the key: yaml-cpp places a missing value on the line after it.
    const std::string text = value.IsScalar() ? fmt::format("'{}'", value.Scalar()) : "the value";
    throw_parse_error(path_, lines_.at(key),
                      fmt::format("key '{}{}': {} is not {}", prefix_, key, text, expected));
  }
  [[nodiscard]] double to_number(const YAML::Node& value, const std::string& key, const std::string& expected,
                                 Range range) const {
    double number = 0;
    const bool is_number = value.IsScalar() && YAML::convert<double>::decode(value, number);
    // Written so that NaN fails, too.
    if (!is_number || !(number >= range.low && number <= range.high)) reject(value, key, expected);
    return number;
  }
  static std::string number_in(Range range) {
    return fmt::format("a number from {} to {}", range.low, range.high);
  }

  std::filesystem::path path_;
  std::string prefix_;
  YAML::Node node_;
  std::map<std::string, size_t> lines_;  ///< of the keys present
};

constexpr const char* kNoDistortion = "none";

/// The model is that of the key `model`, else that with this number of coefficients.
LensDistortion read_distortion(const Block& block) {
  constexpr Range kCoefficients{-100, 100};
  const auto read = [&](const std::vector<size_t>& counts, const std::string& example) {
    return block.numbers("distortion", counts, example, kCoefficients);
  };
  std::string model;
  if (block.has("model")) {
    auto names = names_of<LensModel>();
    names.emplace_back(kNoDistortion);
    model = block.name("model", names);
  }
  if (model == kNoDistortion) {
    block.refuse("distortion", "the model none has no coefficients; remove one of the two keys");
    return {};
  }
  if (model == name_of(LensModel::kKannalaBrandt))
    return lens_with(LensModel::kKannalaBrandt, read({4}, "[0, 0, 0, 0]"));
  std::vector<size_t> counts = {5, 8};
  if (model == name_of(LensModel::kBrownConrady)) counts = {5};
  if (model == name_of(LensModel::kRational)) counts = {8};
  const auto d = read(counts, counts.front() == 8 ? "[0, 0, 0, 0, 0, 0, 0, 0]" : "[0, 0, 0, 0, 0]");
  return lens_with(d.size() == 8 ? LensModel::kRational : LensModel::kBrownConrady, d);
}

/// Reads a pinhole camera for the given image size; the ranges admit any lens, from fish-eye to telephoto,
/// and crops of larger images.
PinholeCamera read_lens(const Block& block, int width, int height) {
  constexpr double kFocalRange = 10;
  const double extent_px = width + height;
  const Range focal_px{extent_px / kFocalRange, extent_px * kFocalRange};
  PinholeCamera camera;
  camera.width = width, camera.height = height;
  camera.fx = block.number("fx", "525", focal_px);
  camera.fy = block.number("fy", "525", focal_px);
  camera.cx = block.number("cx", "319.5", {-1.0 * width, 2.0 * width});
  camera.cy = block.number("cy", "239.5", {-1.0 * height, 2.0 * height});
  camera.lens = read_distortion(block);
  return camera;
}

PinholeCamera read_depth_camera(const Block& block, const PinholeCamera& color) {
  return read_lens(block, block.has("width") ? block.size_px("width", "640") : color.width,
                   block.has("height") ? block.size_px("height", "480") : color.height);
}

DepthSensor read_sensor(const Block& block) {
  const std::string name = block.name("sensor", names_of<DepthSensorModel>());
  return depth_sensor(value_named<DepthSensorModel>(name).value(), SensorOrigin::kCameraFile);
}

SE3 read_motion(const Block& block) {
  constexpr Range kRadians{-7, 7}, kMetres{-10, 10};
  return {exp_so3(block.vector3("rotation_vector", kRadians)), block.vector3("translation", kMetres)};
}

YAML::Node parse_yaml(const std::string& text, const std::filesystem::path& path) {
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw_parse_error(path, line_of(error.mark),
                      fmt::format("not YAML: {}; expected lines 'key: value'", error.msg));
  }
}

std::string lens_text(const PinholeCamera& c, const char* separator) {
  return fmt::format(
      "width: {1}{0}height: {2}{0}fx: {3}{0}fy: {4}{0}cx: {5}{0}cy: {6}{0}{7}distortion: [{8}]", separator,
      c.width, c.height, c.fx, c.fy, c.cx, c.cy,
      c.lens.model == LensModel::kBrownConrady ? ""
                                               : fmt::format("model: {}{}", name_of(c.lens.model), separator),
      fmt::join(lens_coefficients(c.lens), ", "));
}

const char* coefficient_names(LensModel model) {
  if (model == LensModel::kKannalaBrandt) return "k1 k2 k3 k4";
  return model == LensModel::kRational ? "k1 k2 p1 p2 k3 k4 k5 k6" : "k1 k2 p1 p2 k3";
}

}  // namespace

RgbdCamera read_camera_file(const std::filesystem::path& path) {
  return read_camera_text(read_file(path), path);
}

RgbdCamera read_camera_text(const std::string& text, const std::filesystem::path& path) {
  const Block block(
      path, "", parse_yaml(text, path),
      {"width", "height", "fx", "fy", "cx", "cy", "model", "distortion", "depth_scale", "fps",
       "rolling_shutter_s", "depth_offset_s", "depth_shift_m", "sensor", "depth", "T_color_depth"});
  RgbdCamera camera;
  camera.color = read_lens(block, block.size_px("width", "640"), block.size_px("height", "480"));
  camera.depth_scale = block.number_per_metre("depth_scale", "5000", {1, 1e5});
  camera.fps = block.number("fps", "30", {0.001, 1e4});
  if (block.has("rolling_shutter_s"))
    camera.rolling_shutter_s = block.number_or_zero("rolling_shutter_s", "seconds", {0, 1});
  camera.depth_delay_s = block.number_or_zero("depth_offset_s", "seconds", {-1, 1});
  camera.depth_shift_m = block.number_or_zero("depth_shift_m", "metres", {-1, 1});
  if (block.has("sensor")) camera.sensor = read_sensor(block);
  if (block.has("depth")) {
    const Block depth(path, "depth.", block.at("depth", ""),
                      {"width", "height", "fx", "fy", "cx", "cy", "model", "distortion"});
    const Block motion(path, "T_color_depth.",
                       block.at("T_color_depth", "{translation: [0.025, 0, 0], rotation_vector: [0, 0, 0]}"),
                       {"translation", "rotation_vector"});
    camera.depth = read_depth_camera(depth, camera.color);
    camera.T_color_depth = read_motion(motion);
  } else if (block.has("T_color_depth")) {
    throw_parse_error(path, line_of(block.at("T_color_depth", "").Mark()),
                      "key 'T_color_depth' without 'depth'; add the depth camera, or remove the key if depth "
                      "is registered to colour");
  }
  return camera;
}

std::string camera_file_text(const RgbdCamera& camera) {
  std::string text =
      lens_text(camera.color, "\n") + fmt::format("  # {}\n", coefficient_names(camera.color.lens.model));
  text += fmt::format("depth_scale: {}  # units of the depth image per metre\nfps: {}\n", camera.depth_scale,
                      camera.fps);
  if (camera.rolling_shutter_s) text += fmt::format("rolling_shutter_s: {}\n", *camera.rolling_shutter_s);
  if (camera.depth_delay_s != 0) text += fmt::format("depth_offset_s: {}\n", camera.depth_delay_s);
  if (camera.depth_shift_m != 0) text += fmt::format("depth_shift_m: {}\n", camera.depth_shift_m);
  if (camera.sensor.origin != SensorOrigin::kAssumed)
    text += fmt::format("sensor: {}\n", name_of(camera.sensor.model));
  if (camera.depth) {
    const Eigen::Vector3d& t = camera.T_color_depth.translation;
    const Eigen::Vector3d r = log_so3(camera.T_color_depth.rotation);
    text += fmt::format("depth: {{{}}}\n", lens_text(*camera.depth, ", "));
    text += fmt::format("T_color_depth: {{translation: [{}, {}, {}], rotation_vector: [{}, {}, {}]}}\n",
                        t.x(), t.y(), t.z(), r.x(), r.y(), r.z());
  }
  return text;
}

void write_camera_file(const std::filesystem::path& path, const RgbdCamera& camera) {
  write_file(path, camera_file_text(camera));
}

}  // namespace kinloop
