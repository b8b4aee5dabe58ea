// Two folders of images without lists, such as rgb/ and depth/. The camera is to be given, or lies in the
// folder.

#include <fmt/format.h>

#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/lists/frame_masks.hpp"
#include "drivers/datasets/reading/lists/pair_images.hpp"

namespace kinloop {
namespace {

std::string plain_evidence(const std::filesystem::path& folder, const FolderContents& contents) {
  const std::string color = color_folder(contents), depth = depth_folder(contents);
  const bool lists = contents.has_file("rgb.txt") || contents.has_file("depth.txt");  // TUM, incomplete
  if (lists || color.empty() || depth.empty()) return {};
  const bool images = !FolderContents(folder / color).first_image().empty();
  return images ? fmt::format("{}/ {}/", color, depth) : "";
}

RecordedSequence read_plain(const std::filesystem::path& folder) {
  const FolderContents contents(folder);
  RecordedSequence sequence;
  sequence.layout = "folder of colour and depth images";
  pair_folders(folder / color_folder(contents), folder / depth_folder(contents), stated_fps(folder),
               sequence);
  find_masks(folder, sequence);
  return sequence;
}

}  // namespace

double stated_fps(const std::filesystem::path& folder) {
  const auto file = folder / "camera.yaml";
  std::error_code absent;
  return std::filesystem::exists(file, absent) ? read_camera_description(file).camera.fps : RgbdCamera{}.fps;
}

SequenceLayout plain_layout() {
  return {"colour and depth images", "rgb/, color/, image/ or images/, and depth/", plain_evidence,
          read_plain};
}

}  // namespace kinloop
