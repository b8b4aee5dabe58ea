// One folder with colour and depth images side by side, told apart by their names: 0001_color.png and
// 0001_depth.png, or color_0001.png and depth_0001.png. The camera is to be given, or lies in the folder.

#include <array>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/lists/frame_masks.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/lists/pair_images.hpp"
#include "kinloop/core/text/lower_case.hpp"

namespace kinloop {
namespace {

/// What the names of colour and depth images begin or end with.
struct FlatNames {
  const char* color;
  const char* depth;
  bool at_the_end;

  [[nodiscard]] bool is(const std::filesystem::path& image, const char* word) const {
    const std::string stem = lower_case(image.stem().string());
    if (stem.find_first_of("0123456789") == std::string::npos) return false;  // one picture, not a sequence
    return at_the_end ? stem.ends_with(word) : stem.starts_with(word);
  }
};

constexpr std::array kFlatNames = {
    FlatNames{"_color", "_depth", true}, FlatNames{"_rgb", "_depth", true},
    FlatNames{"-color", "-depth", true}, FlatNames{"-rgb", "-depth", true},
    FlatNames{"color", "depth", false},  FlatNames{"rgb", "depth", false},
};

struct FlatImages {
  std::vector<std::filesystem::path> color, depth;
};

/// By the first of the names that both kinds of images have; none if there is no such name.
FlatImages flat_images(const std::vector<std::filesystem::path>& files) {
  for (const FlatNames& names : kFlatNames) {
    FlatImages found;
    for (const auto& file : files) {
      if (is_color_name(file) && names.is(file, names.color)) found.color.push_back(file);
      if (is_depth_name(file) && names.is(file, names.depth)) found.depth.push_back(file);
    }
    if (!found.color.empty() && !found.depth.empty()) return found;
  }
  return {};
}

bool is_depth_or_color_name(const std::filesystem::path& file) {
  return is_color_name(file) || is_depth_name(file);
}

std::string flat_evidence(const std::filesystem::path&, const FolderContents& contents) {
  if (contents.has_file("rgb.txt") || contents.has_file("depth.txt")) return {};  // TUM, incomplete
  const FlatImages found = flat_images({contents.files().begin(), contents.files().end()});
  if (found.color.empty()) return {};
  return fmt::format("{}, {}", found.color.front().string(), found.depth.front().string());
}

RecordedSequence read_flat(const std::filesystem::path& folder) {
  RecordedSequence sequence;
  sequence.layout = "folder of colour and depth images";
  const FlatImages found = flat_images(images_in(folder, is_depth_or_color_name));
  if (!found.color.empty()) pair_images(found.color, found.depth, stated_fps(folder), sequence);
  find_masks(folder, sequence);
  return sequence;
}

}  // namespace

SequenceLayout flat_layout() {
  return {"images side by side", "0001_color.png and 0001_depth.png, or color_0001.png and depth_0001.png",
          flat_evidence, read_flat};
}

}  // namespace kinloop
