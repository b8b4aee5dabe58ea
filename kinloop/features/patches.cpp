#include "kinloop/features/patches.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

std::optional<Patch> cut_patch(const cv::Mat& image, const Eigen::Vector2d& position, int octave) {
  const int left = static_cast<int>(std::lround(position.x())) - Patch::kSize / 2;
  const int top = static_cast<int>(std::lround(position.y())) - Patch::kSize / 2;
  if (left < 0 || top < 0 || left + Patch::kSize > image.cols || top + Patch::kSize > image.rows)
    return std::nullopt;
  Patch patch;
  for (int row = 0; row < Patch::kSize; ++row) {
    std::memcpy(&patch.texels[static_cast<size_t>(row) * Patch::kSize], image.ptr(top + row) + left,
                Patch::kSize);
  }
  patch.center = (position - Eigen::Vector2d(left, top)).cast<float>();
  patch.octave = octave;
  return patch;
}

}  // namespace

int octave_of_level(const Features& features, int level) {
  return static_cast<int>(std::lround(level * std::log2(features.scale_factor)));
}

KeypointPatches::KeypointPatches(const std::vector<bool>& has_patch, const std::vector<Patch>& patches)
    : index_of_(has_patch.size(), kNone), patch_count_(patches.size()) {
  uint32_t next = 0;
  for (size_t i = 0; i < has_patch.size(); ++i) {
    if (has_patch[i]) index_of_[i] = next++;
  }
  require(next == patches.size(), "KeypointPatches: one patch for each keypoint that has one");
  auto storage = std::make_shared<std::vector<Patch>>(patches);  // exactly as large as needed
  patches_ = std::shared_ptr<const Patch>(storage, storage->data());
}

KeypointPatches cut_patches(const ImageOctaves& octaves, const Features& features,
                            const std::vector<bool>& wanted) {
  require(!octaves.empty(), "cut_patches: no image");
  std::vector<bool> has_patch(features.size(), false);
  std::vector<Patch> patches;
  for (size_t i = 0; i < features.size(); ++i) {
    if (!wanted[i]) continue;
    const int octave =
        std::min(octave_of_level(features, features.levels[i]), static_cast<int>(octaves.size()) - 1);
    const auto patch = cut_patch(octaves[static_cast<size_t>(octave)],
                                 to_octave(features.raw_pixels[i].cast<double>(), octave), octave);
    if (!patch) continue;
    has_patch[i] = true;
    patches.push_back(*patch);
  }
  return {has_patch, patches};
}

}  // namespace kinloop
