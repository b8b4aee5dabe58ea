// transforms.json of Nerfstudio, instant-ngp and NeRFCapture (SplaTAM's captures of an iPhone): for each
// frame "file_path", "depth_file_path" (Nerfstudio) or "depth_path" (NeRFCapture), and "transform_matrix",
// the pose of a camera with y up that looks along -z. Frames without a file of depth are paired as in two
// folders.

#include <algorithm>
#include <array>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/json_file.hpp"
#include "drivers/datasets/reading/lists/frame_masks.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/lists/name_times.hpp"
#include "drivers/datasets/reading/lists/pair_images.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr std::array kTransforms = {"transforms.json", "transforms_train.json"};  // the latter of Blender

/// A frame as the file lists it.
struct ListedFrame {
  fs::path color, depth;  ///< depth: empty if not listed
  std::optional<SE3> T_world_camera;
  std::optional<double> stamp_s;
};

/// Whether the file names depth images, as a search for their key tells.
bool names_depth(const fs::path& file) {
  constexpr size_t kLookedAt = 1 << 16;
  std::ifstream stream(file, std::ios::binary);
  std::string beginning(kLookedAt, '\0');
  stream.read(beginning.data(), kLookedAt);
  beginning.resize(static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return beginning.find("\"depth") != std::string::npos;
}

std::string transforms_evidence(const fs::path& folder, const FolderContents& contents) {
  for (const char* name : kTransforms) {
    if (!contents.has_file(name)) continue;
    const bool folders = !color_folder(contents).empty() && !depth_folder(contents).empty();
    if (folders || names_depth(folder / name)) return name;
  }
  return {};
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
  for (const char* ending : {"", ".png", ".jpg", ".jpeg", ".PNG", ".JPG", ".webp"}) {
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
    const auto stamp = frame.find("timestamp");
    const bool stamped = stamp != frame.end() && stamp->is_number();
    frames.push_back(
        {color, depth, transform_of(frame), stamped ? std::optional(stamp->get<double>()) : std::nullopt});
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

/// The frames that the file lists with depth, with its times or those of the names, where there are any.
void take_listed(const std::vector<ListedFrame>& listed, const fs::path& folder, RecordedSequence& sequence) {
  std::vector<fs::path> color;
  for (const ListedFrame& frame : listed) {
    if (frame.depth.empty()) continue;
    const int64_t stamp_ns = frame.stamp_s ? checked_stamp(*frame.stamp_s, frame.color) : 0;
    sequence.frames.push_back({stamp_ns, stamp_ns, {frame.color}, {frame.depth}, {}, 0});
    color.push_back(frame.color);
  }
  const bool stamped = std::all_of(listed.begin(), listed.end(),
                                   [](const ListedFrame& frame) { return frame.stamp_s.has_value(); });
  const auto times = stamped ? std::nullopt : times_in_names(color);
  sequence.stamps_measured = stamped || times;
  for (size_t i = 0; times && i < color.size(); ++i)
    sequence.frames[i].stamp_ns = sequence.frames[i].depth_stamp_ns = times->stamps_ns[i];
  if (!sequence.stamps_measured) return stamp_by_rate(sequence.frames, stated_fps(folder));
  keep_increasing(sequence);
}

RecordedSequence read_transforms_folder(const fs::path& folder) {
  const FolderContents contents(folder);
  const auto listed = listed_frames(read_json(folder / transforms_evidence(folder, contents)), folder);
  RecordedSequence sequence;
  sequence.layout = "folder with transforms.json";
  sequence.truth_in_metres = false;  // Nerfstudio's poses often come from COLMAP
  if (is_listed_with_depth(listed)) {
    take_listed(listed, folder, sequence);
  } else if (color_folder(contents).empty() || depth_folder(contents).empty()) {
    throw InputError(fmt::format(
        "{}: none of its {} frames has a colour and a depth image that are there; copy the images",
        (folder / transforms_evidence(folder, contents)).string(), listed.size()));
  } else {
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
  return {"Nerfstudio, NeRFCapture", "transforms.json that lists depth, or with depth/ and rgb/ or images/",
          transforms_evidence, read_transforms_folder};
}

}  // namespace kinloop
