#include "drivers/datasets/folder_contents.hpp"

#include <algorithm>
#include <initializer_list>

#include <fmt/format.h>

#include "kinloop/core/text/lower_case.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return std::binary_search(names.begin(), names.end(), name, std::less<>());
}

/// A layout, and the file or folder it is recognised by; empty if the folder does not have it.
struct KnownLayout {
  const char* name;
  std::string (*evidence)(const fs::path& folder, const FolderContents& contents);
};

std::string kitti(const fs::path&, const FolderContents& c) {
  for (const char* images : {"image_2", "image_0", "image_02", "image_00"}) {
    if (c.has_folder(images)) return fmt::format("{}/", images);
  }
  return {};
}

constexpr KnownLayout kUnreadableLayouts[] = {
    {"ICL-NUIM's POV-Ray files",
     [](const fs::path&, const FolderContents& c) { return c.find_file("scene_", ".depth"); }},
    {"EuRoC", [](const fs::path&,
                 const FolderContents& c) { return std::string(c.has_folder("mav0") ? "mav0/" : ""); }},
    {"KITTI", kitti},
};

}  // namespace

FolderContents::FolderContents(const fs::path& folder) : folder_(folder) {
  constexpr size_t kMaxCount = 4096;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code broken_link;
    auto& names = entry->is_directory(broken_link) ? folders_ : files_;
    names.push_back(entry->path().filename().string());
    complete_ = files_.size() + folders_.size() < kMaxCount;
    if (!complete_) break;
  }
  std::sort(files_.begin(), files_.end());
  std::sort(folders_.begin(), folders_.end());
}

bool FolderContents::has_file(std::string_view name) const {
  std::error_code absent;
  return contains(files_, name) || (!complete_ && fs::is_regular_file(folder_ / name, absent));
}

bool FolderContents::has_folder(std::string_view name) const {
  std::error_code absent;
  return contains(folders_, name) || (!complete_ && fs::is_directory(folder_ / name, absent));
}

std::string FolderContents::find_file(std::string_view beginning, std::string_view end) const {
  const auto found = std::find_if(files_.begin(), files_.end(), [&](const std::string& name) {
    return name.starts_with(beginning) && name.ends_with(end);
  });
  return found == files_.end() ? std::string() : *found;
}

std::string FolderContents::first_image() const {
  const auto found =
      std::find_if(files_.begin(), files_.end(), [](const std::string& name) { return is_color_name(name); });
  return found == files_.end() ? std::string() : *found;
}

namespace {

/// The first of the names that a folder has, in lower case or any other.
std::string first_folder(const FolderContents& contents, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    if (contents.has_folder(name)) return std::string(name);
    for (const std::string& folder : contents.folders()) {
      if (lower_case(folder) == name) return folder;
    }
  }
  return {};
}

}  // namespace

std::string color_folder(const FolderContents& contents) {
  return first_folder(contents, {"rgb", "color", "colour", "image", "images", "colors", "imgs", "rgbs",
                                 "rgb_images", "color_images", "mono", "gray", "grey"});
}

std::string depth_folder(const FolderContents& contents) {
  // Where both are, "depth" may be as the depth camera saw it.
  return first_folder(contents, {"aligned_depth", "aligned_depth_to_color", "depth_aligned", "depth",
                                 "depths", "depth_png", "depth_images"});
}

namespace {

bool ends_like_one_of(const fs::path& file, std::initializer_list<std::string_view> endings) {
  return std::find(endings.begin(), endings.end(), lower_case(file.extension().string())) != endings.end();
}

}  // namespace

bool is_color_name(const fs::path& file) {
  return ends_like_one_of(
      file, {".png", ".jpg", ".jpeg", ".ppm", ".pgm", ".pnm", ".bmp", ".tif", ".tiff", ".webp"});
}

bool is_depth_name(const fs::path& file) {
  return ends_like_one_of(file, {".png", ".pgm", ".exr", ".tif", ".tiff", ".npy", ".npz", ".yml", ".raw"});
}

std::string folder_name(const fs::path& folder) {
  const auto normal = fs::absolute(folder).lexically_normal();
  return (normal.has_filename() ? normal : normal.parent_path()).filename().string();
}

std::string detect_dataset_layout(const fs::path& folder) {
  const FolderContents contents(folder);
  for (const KnownLayout& layout : kUnreadableLayouts) {
    const std::string evidence = layout.evidence(folder, contents);
    if (!evidence.empty()) return fmt::format("{} ({})", layout.name, evidence);
  }
  return {};
}

}  // namespace kinloop
