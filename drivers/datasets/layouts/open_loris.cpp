// OpenLORIS-Scene (Shi et al. 2020): color.txt and aligned_depth.txt ("stamp file"), depth in millimetres,
// sensors.yaml and trans_matrix.yaml by OpenCV, and groundtruth.txt of the robot's base_link.

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/lists/tum_listing.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "drivers/datasets/reading/two_lenses.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/geometry/ground_truth.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kColorFrame = "d400_color_optical_frame";
constexpr const char* kBaseFrame = "base_link";

std::string open_loris_evidence(const fs::path&, const FolderContents& contents) {
  const bool fits = contents.has_file("color.txt") && contents.has_file("aligned_depth.txt");
  return fits ? "color.txt, aligned_depth.txt" : "";
}

/// The file as OpenCV writes it, passed to `read`; exceptions of the parser become InputError. OpenCV's own
/// parser exhausts the stack on nested input and allocates whatever size a damaged matrix claims.
template <class Read>
auto with_yaml(const fs::path& file, const Read& read) {
  constexpr uint64_t kMostBytes = uint64_t{1} << 20;
  require_size(file, kMostBytes);
  const std::string text = read_file(file);
  const size_t begin = text.starts_with("%YAML") ? std::min(text.find('\n'), text.size()) : 0;  // "%YAML:1.0"
  try {
    return read(YAML::Load(text.substr(begin)));
  } catch (const YAML::Exception&) {
    throw InputError(fmt::format("{}: not a YAML file by OpenCV; copy it again", file.string()));
  }
}

/// The numbers of a matrix.
std::vector<double> numbers_of(const YAML::Node& matrix) {
  std::vector<double> numbers;
  for (const YAML::Node& value : matrix["data"]) numbers.push_back(value.as<double>());
  return numbers;
}

/// "intrinsics" are fx, cx, fy, cy.
RgbdCamera read_loris_camera(const fs::path& file) {
  constexpr double kMillimetres = 1000;
  return with_yaml(file, [&](const YAML::Node& root) {
    const YAML::Node node = root[kColorFrame];
    const auto k = node && node["intrinsics"] ? numbers_of(node["intrinsics"]) : std::vector<double>();
    if (k.size() != 4) {
      throw InputError(
          fmt::format("{}: no '{}' with four 'intrinsics'; copy it again", file.string(), kColorFrame));
    }
    const cv::Size size = checked_size(node["width"].as<double>(), node["height"].as<double>(), file);
    const PinholeCamera lens = checked_lens(make_lens(size, k[0], k[2], k[1], k[3]), file);
    return camera_of({lens, lens, {}, {}}, kMillimetres, file);
  });
}

/// The pose of the colour camera in base_link, along a chain of entries "parent, child, T_parent_child".
std::optional<SE3> read_base_to_color(const fs::path& file) {
  constexpr int kLongestChain = 8;
  std::map<std::string, std::pair<std::string, SE3>> parent_of;
  with_yaml(file, [&](const YAML::Node& root) {
    for (const YAML::Node& entry : root["trans_matrix"]) {
      const auto matrix = matrix_of(numbers_of(entry["matrix"]));
      const auto T = matrix ? rigid_motion(*matrix) : std::nullopt;
      if (T)
        parent_of[entry["child_frame"].as<std::string>()] = {entry["parent_frame"].as<std::string>(), *T};
    }
    return true;
  });
  SE3 T_frame_color;
  std::string frame = kColorFrame;
  for (int i = 0; i < kLongestChain && frame != kBaseFrame; ++i) {
    const auto found = parent_of.find(frame);
    if (found == parent_of.end()) return std::nullopt;
    T_frame_color = found->second.second * T_frame_color;
    frame = found->second.first;
  }
  return frame == kBaseFrame ? std::optional(T_frame_color) : std::nullopt;
}

Trajectory read_loris_truth(const fs::path& folder) {
  std::error_code absent;
  if (!fs::exists(folder / "groundtruth.txt", absent)) return {};
  Trajectory truth = read_ground_truth(folder / "groundtruth.txt");
  const fs::path file = folder / "trans_matrix.yaml";
  const auto T_base_color = fs::exists(file, absent) ? read_base_to_color(file) : std::nullopt;
  if (!T_base_color) {
    log::warn("{}: no transform from {} to {}: the ground truth, which is of the robot, is not used",
              file.string(), kBaseFrame, kColorFrame);
    return {};
  }
  for (StampedPose& pose : truth) pose.T_world_camera = pose.T_world_camera * *T_base_color;
  return truth;
}

RecordedSequence read_open_loris(const fs::path& folder) {
  RecordedSequence sequence;
  sequence.layout = "OpenLORIS folder";
  TumListing listing = associate_lists(folder, "color.txt", "aligned_depth.txt");
  sequence.frames = std::move(listing.frames);
  sequence.skipped = std::move(listing.skipped);
  sequence.pairing = std::move(listing.pairing);
  sequence.camera_remedy = "no sensors.yaml; copy it from the dataset";
  std::error_code absent;
  if (fs::exists(folder / "sensors.yaml", absent)) {
    sequence.camera = read_loris_camera(folder / "sensors.yaml");
    sequence.sensor = DepthSensorModel::kRealsenseD4xx;
    sequence.camera->fps = median_rate_hz(sequence.frames, sequence.camera->fps);
  }
  sequence.ground_truth = read_loris_truth(folder);
  return sequence;
}

}  // namespace

SequenceLayout open_loris_layout() {
  return {"OpenLORIS", "color.txt and aligned_depth.txt", open_loris_evidence, read_open_loris};
}

}  // namespace kinloop
