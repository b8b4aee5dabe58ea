// Two folders of images without lists: rgb/ or color/, and depth/. The camera is to be given.

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/frame_masks.hpp"
#include "drivers/datasets/reading/image_pairs.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"

namespace kinloop {
namespace {

std::string plain_evidence(const std::filesystem::path& folder, const FolderContents& contents) {
  const std::string color = color_folder(contents);
  const bool lists = contents.has_file("rgb.txt") || contents.has_file("depth.txt");  // TUM, incomplete
  if (lists || color.empty() || !contents.has_folder("depth")) return {};
  const bool images = !FolderContents(folder / color).first_image().empty();
  return images ? fmt::format("{}/ depth/", color) : "";
}

RecordedSequence read_plain(const std::filesystem::path& folder) {
  RecordedSequence sequence;
  sequence.layout = "folder of colour and depth images";
  const auto camera = folder / "camera.yaml";
  const double fps = std::filesystem::exists(camera) ? read_camera_file(camera).fps : RgbdCamera{}.fps;
  pair_folders(folder / color_folder(FolderContents(folder)), folder / "depth", fps, sequence);
  find_masks(folder, sequence);
  return sequence;
}

}  // namespace

SequenceLayout plain_layout() {
  return {"colour and depth images", "rgb/ or color/, and depth/", plain_evidence, read_plain};
}

}  // namespace kinloop
