#include "kinloop/features/patches.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

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

KeypointPatches cut_patches(const ImageOctaves& octaves, const Features& features,
                            const std::vector<bool>& wanted) {
  KeypointPatches patches(features.size());
  for (size_t i = 0; i < features.size(); ++i) {
    if (!wanted[i]) continue;
    const int octave =
        std::min(octave_of_level(features, features.levels[i]), static_cast<int>(octaves.size()) - 1);
    const auto patch = cut_patch(octaves[static_cast<size_t>(octave)],
                                 to_octave(features.raw_pixels[i].cast<double>(), octave), octave);
    if (patch) patches.add(i, *patch);
  }
  patches.shrink_to_fit();
  return patches;
}

}  // namespace kinloop
