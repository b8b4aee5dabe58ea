#include "drivers/datasets/sequence_layout.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "drivers/datasets/camera_files/camera_template.hpp"
#include "drivers/datasets/folder_contents.hpp"
#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/sequences_below.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/text/did_you_mean.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCannotYet = "which kinloop cannot read; convert it to TUM layout";

/// A required file of the layout.
struct RequiredFile {
  const char* name;
  const char* meaning;
};
constexpr RequiredFile kLists[] = {
    {"rgb.txt", "a line 'timestamp file' for each colour image (8-bit PNG or JPEG)"},
    {"depth.txt", "a line 'timestamp file' for each depth image (16-bit PNG)"},
};
constexpr RequiredFile kCamera = {"camera.yaml", "the camera; or specify --camera"};
constexpr const char* kPresets = "freiburg1, freiburg2, freiburg3, icl";

std::vector<RequiredFile> missing_in(const fs::path& folder, bool camera_known) {
  std::vector<RequiredFile> missing;
  std::error_code absent;
  for (const RequiredFile& list : kLists) {
    if (!has_tum_lists(folder) && !fs::exists(folder / list.name, absent)) missing.push_back(list);
  }
  if (!camera_known) missing.push_back(kCamera);
  return missing;
}

std::string names_of(const std::vector<RequiredFile>& files) {
  std::vector<std::string> names;
  for (const RequiredFile& file : files) names.emplace_back(file.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Lists what the folder was searched for, and what to add to make it a sequence.
std::string hint_for(const std::vector<RequiredFile>& missing, bool camera_known) {
  std::string hint = "Looked for:\n";
  for (const SequenceLayout& layout : sequence_layouts())
    hint += fmt::format("  {:<25} {}\n", layout.name, layout.looked_for);
  hint += "Missing for a sequence in TUM layout:\n";
  for (const RequiredFile& file : missing) hint += fmt::format("  {:<12} {}\n", file.name, file.meaning);
  return camera_known ? hint : hint + camera_template({});
}

/// Nonexistent path: a sequence to be downloaded, or a misspelt name.
[[noreturn]] void reject_absent(const fs::path& path) {
  constexpr std::string_view kTum = "rgbd_dataset_freiburg";
  const fs::path normal = path.has_filename() ? path : path.parent_path();
  const std::string name = normal.filename().string();
  if (name.starts_with(kTum)) {
    throw InputError(fmt::format("{}: no such folder; check the path, or download it: kinloop fetch tum/fr{}",
                                 path.string(), name.substr(kTum.size())));
  }
  const FolderContents beside(normal.has_parent_path() ? normal.parent_path() : fs::path("."));
  auto names = beside.folders();
  for (const char* source : {"sim:room", "kinect1", "kinect2", "openni2", "realsense", "orbbec", "oak"})
    names.emplace_back(source);
  const std::string guess = did_you_mean(name, names);
  throw InputError(
      fmt::format("{}: no such folder{}", path.string(), guess.empty() ? "; check the path" : guess));
}

/// Remedy if a file was given instead of a folder.
std::string advice_for_file(const fs::path& file) {
  struct Kind {
    std::vector<const char*> endings;
    const char* remedy;
  };
  static const std::vector<Kind> kKinds = {
      {{".kinmap"}, "a map; continue it with --load-map or open it with kinloop view"},
      {{".ply", ".pcd"}, "a cloud; open it with kinloop view"},
      {{".mp4", ".avi", ".mov", ".webm"},
       "a video, which kinloop cannot read yet; colour and depth images are needed, in a folder in TUM "
       "layout"},
      {{".klg", ".svo"},
       "a recording of another program, which kinloop cannot read yet; convert it to TUM layout"},
      {{".gz", ".bz2", ".xz", ".zst", ".rar"}, "an archive; unpack it and give the folder"},
      {{".png", ".jpg", ".jpeg"}, "one image; give the folder of the sequence"},
      {{".txt", ".yaml"}, "a text file; give the folder of the sequence"},
  };
  for (const Kind& kind : kKinds) {
    for (const char* ending : kind.endings) {
      if (file.extension() == ending) return kind.remedy;
    }
  }
  return "not a folder; give the folder of a sequence, a bag (.bag, .mcap, .db3) or a .mkv of the Azure "
         "Kinect";
}

/// The layout of another dataset, in the folder or one level below; empty if none is recognised.
std::string foreign_layout_around(const fs::path& folder) {
  if (std::string layout = detect_dataset_layout(folder); !layout.empty()) return layout;
  constexpr size_t kMaxFolders = 16;
  const FolderContents contents(folder);
  const auto& below = contents.folders();
  for (size_t i = 0; i < std::min(below.size(), kMaxFolders); ++i) {
    const std::string layout = detect_dataset_layout(folder / below[i]);
    if (!layout.empty()) return fmt::format("{}, in {}/", layout, below[i]);
  }
  return {};
}

/// ": .heic, .txt; convert the images to PNG or JPEG": the endings of the files in a folder.
std::string endings_in(const fs::path& folder) {
  constexpr size_t kMost = 5;
  std::set<std::string> endings;
  const FolderContents contents(folder);
  for (const std::string& name : contents.files()) {
    if (endings.size() < kMost && fs::path(name).has_extension())
      endings.insert(fs::path(name).extension().string());
  }
  if (endings.empty()) return "";
  return fmt::format(", only {}; convert images to PNG or JPEG", fmt::join(endings, ", "));
}

/// What the folder is or lacks; empty if nothing is recognised.
std::string description_of(const fs::path& folder) {
  const FolderContents contents(folder);
  if (contents.empty()) return "an empty folder";
  if (const std::string color = color_folder(contents); !color.empty() && !depth_folder(contents).empty())
    return fmt::format("{}/ without images that kinloop can read{}", color, endings_in(folder / color));
  const std::string image = contents.first_image();
  if (!image.empty() && contents.folders().empty()) {
    return fmt::format("a folder of images ({}, ...); each colour image needs a depth image", image);
  }
  return {};
}

}  // namespace

bool is_incomplete_tum(const FolderContents& contents) {
  return contents.has_file("rgb.txt") || contents.has_file("depth.txt");
}

bool is_run_folder(const FolderContents& contents) {
  return contents.has_file("run.json") && contents.has_file("trajectory.txt");
}

bool has_tum_lists(const fs::path& folder) {
  std::error_code absent;
  return fs::exists(folder / "associations.txt", absent) ||
         (fs::exists(folder / "rgb.txt", absent) && fs::exists(folder / "depth.txt", absent));
}

void reject_sequence(const fs::path& path, bool camera_known) {
  std::error_code absent;
  const std::string name = path.string();
  if (!fs::exists(path, absent)) reject_absent(path);
  if (!fs::is_directory(path, absent)) throw InputError(fmt::format("{}: {}", name, advice_for_file(path)));
  const auto missing = missing_in(path, camera_known);
  if (has_tum_lists(path)) reject_without_camera(path, RecordedSequence{});
  const std::string hint = hint_for(missing, camera_known);
  const FolderContents contents(path);
  if (is_incomplete_tum(contents)) {
    throw InputErrorWithHint(
        fmt::format("{}: not a complete sequence in TUM layout: no {}", name, names_of(missing)), hint);
  }
  if (is_run_folder(contents)) {
    throw InputError(
        fmt::format("{}: the results of a run, not a sequence; open them with kinloop view {}", name, name));
  }
  reject_several_sequences(path);
  const std::string layout = foreign_layout_around(path);
  if (!layout.empty()) {
    throw InputErrorWithHint(fmt::format("{}: looks like {}, {}", name, layout, kCannotYet), hint);
  }
  const std::string description = description_of(path);
  throw InputErrorWithHint(
      fmt::format("{}: not a sequence in a known layout: {}", name,
                  description.empty() ? fmt::format("no {}", names_of(missing)) : description),
      hint);
}

void reject_without_camera(const fs::path& path, const RecordedSequence& sequence) {
  const std::string& remedy = sequence.camera_remedy;
  throw InputErrorWithHint(
      fmt::format("{}: no camera: {}, or use --camera FILE or one of {}, or --intrinsics fx,fy,cx,cy",
                  path.string(), remedy.empty() ? "add a camera.yaml" : remedy, kPresets),
      camera_template(sequence));
}

}  // namespace kinloop
