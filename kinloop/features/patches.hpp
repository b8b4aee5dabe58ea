#pragma once
// Small pieces of an image around its keypoints, from which later frames find the same points again.

#include <array>
#include <cstdint>
#include <vector>

#include "kinloop/features/features.hpp"
#include "kinloop/features/image_octaves.hpp"

namespace kinloop {

/// A square piece of one octave of an image.
struct Patch {
  static constexpr int kSize = 16;  ///< texels per side

  std::array<uint8_t, kSize * kSize> texels{};  ///< row by row
  Eigen::Vector2f center;  ///< of the keypoint, in texels; (0, 0) is the first texel's centre
  int octave = 0;
};

/// Patches of some of the keypoints of an image. The others take no space: a map holds these for ever.
class KeypointPatches {
 public:
  explicit KeypointPatches(size_t keypoints) : index_of_(keypoints, kNone) {}

  /// Adds the patch of a keypoint that has none.
  void add(size_t keypoint, const Patch& patch) {
    index_of_.at(keypoint) = static_cast<uint32_t>(patches_.size());
    patches_.push_back(patch);
  }
  void shrink_to_fit() { patches_.shrink_to_fit(); }

  /// The patch of a keypoint; null if it has none.
  [[nodiscard]] const Patch* find(size_t keypoint) const {
    const uint32_t index = index_of_[keypoint];
    return index == kNone ? nullptr : &patches_[index];
  }
  [[nodiscard]] size_t keypoints() const { return index_of_.size(); }

 private:
  static constexpr uint32_t kNone = UINT32_MAX;

  std::vector<uint32_t> index_of_;  // in patches_, per keypoint
  std::vector<Patch> patches_;
};

/// Patches of the keypoints for which `wanted` is set; a keypoint near the border has none.
KeypointPatches cut_patches(const ImageOctaves& octaves, const Features& features,
                            const std::vector<bool>& wanted);

/// Octave of the pyramid with ratio 2 that is nearest in size to a pyramid level of `features`.
int octave_of_level(const Features& features, int level);

}  // namespace kinloop
