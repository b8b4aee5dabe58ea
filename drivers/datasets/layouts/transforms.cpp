// transforms.json of Nerfstudio, instant-ngp and NeRFCapture (SplaTAM's captures of an iPhone): for each
// frame "file_path", "depth_file_path" (Nerfstudio) or "depth_path" (NeRFCapture), and "transform_matrix",
// the pose of a camera with y up that looks along -z. Frames without a file of depth are paired as in two
// folders.

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/json_file.hpp"
#include "drivers/datasets/reading/lists/frame_masks.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTransforms = "transforms.json";

/// A frame as the file lists it.
struct ListedFrame {
  fs::path color, depth;  ///< depth: empty if not listed
  std::optional<SE3> T_world_camera;
};

std::string transforms_evidence(const fs::path&, const FolderContents& contents) {
  const bool fits =
      contents.has_file(kTransforms) && !color_folder(contents).empty() && !depth_folder(contents).empty();
  return fits ? kTransforms : "";
}

std::string text_at(const nlohmann::json& frame, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    const auto found = frame.find(key);
    if (found != frame.end() && found->is_string()) return found->get<std::string>();
  }
  return {};
}

/// Of a matrix by rows, in one list or in a list of each row.
std::optional<SE3> transform_of(const nlohmann::json& frame) {
  const auto found = frame.find("transform_matrix");
  if (found == frame.end() || !found->is_array()) return std::nullopt;
  std::vector<double> numbers;
  const auto add = [&](const nlohmann::json& value) {
    if (value.is_number()) numbers.push_back(value.get<double>());
  };
  for (const auto& row : *found) {
    if (!row.is_array()) add(row);
    if (row.is_array()) std::for_each(row.begin(), row.end(), add);
  }
  const auto matrix = matrix_of(numbers);
  const auto T = matrix ? rigid_motion(*matrix) : std::nullopt;
  return T ? std::optional(from_arkit(*T)) : std::nullopt;
}

/// instant-ngp leaves out the ending of images.
fs::path image_path(const fs::path& folder, const std::string& name) {
  if (name.empty()) return {};
  fs::path file = (folder / name).lexically_normal();
  std::error_code absent;
  for (const char* ending : {"", ".png", ".jpg"}) {
    fs::path image = file.string() + ending;
    if (fs::is_regular_file(image, absent)) return image;
  }
  return file;
}

std::vector<ListedFrame> listed_frames(const nlohmann::json& json, const fs::path& folder) {
  std::vector<ListedFrame> frames;
  const auto list = json.is_object() ? json.find("frames") : json.end();
  if (list == json.end() || !list->is_array()) return frames;
  for (const auto& frame : *list) {
    if (!frame.is_object()) continue;
    const fs::path color = image_path(folder, text_at(frame, {"file_path"}));
    if (color.empty()) continue;
    const fs::path depth =
        image_path(folder, text_at(frame, {"depth_file_path", "depth_path", "depth_map", "depth"}));
    frames.push_back({color, depth, transform_of(frame)});
  }
  std::sort(frames.begin(), frames.end(), [](const ListedFrame& a, const ListedFrame& b) {
    return natural_less(a.color.string(), b.color.string());
  });
  return frames;
}

bool is_listed_with_depth(const std::vector<ListedFrame>& frames) {
  return std::any_of(frames.begin(), frames.end(), [](const ListedFrame& frame) {
    std::error_code absent;
    return !frame.depth.empty() && fs::exists(frame.color, absent) && fs::exists(frame.depth, absent);
  });
}

RecordedSequence read_transforms_folder(const fs::path& folder) {
  const auto listed = listed_frames(read_json(folder / kTransforms), folder);
  RecordedSequence sequence;
  sequence.layout = "folder with transforms.json";
  sequence.truth_in_metres = false;  // Nerfstudio's poses often come from COLMAP
  if (is_listed_with_depth(listed)) {
    sequence.stamps_measured = false;
    for (const ListedFrame& frame : listed) {
      if (!frame.depth.empty()) sequence.frames.push_back({0, 0, {frame.color}, {frame.depth}, {}, 0});
    }
    stamp_by_rate(sequence.frames, stated_fps(folder));
  } else {
    const FolderContents contents(folder);
    pair_folders(folder / color_folder(contents), folder / depth_folder(contents), stated_fps(folder),
                 sequence);
  }
  std::map<fs::path, SE3> poses;
  for (const ListedFrame& frame : listed) {
    if (frame.T_world_camera) poses.emplace(frame.color, *frame.T_world_camera);
  }
  sequence.ground_truth =
      truth_of(sequence.frames, [&](const RecordedFrame& frame, size_t) -> std::optional<SE3> {
        const auto found = poses.find(frame.color.file.lexically_normal());
        return found == poses.end() ? std::nullopt : std::optional(found->second);
      });
  find_masks(folder, sequence);
  return sequence;
}

}  // namespace

SequenceLayout transforms_layout() {
  return {"Nerfstudio, NeRFCapture", "transforms.json, rgb/ or images/, and depth/", transforms_evidence,
          read_transforms_folder};
}

}  // namespace kinloop
