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
  static constexpr int kNone = -1;

  std::array<uint8_t, kSize * kSize> texels{};  ///< row by row
  Eigen::Vector2f center;  ///< of the keypoint, in texels; (0, 0) is the first texel's centre
  int octave = kNone;      ///< kNone: the keypoint has no patch
};

/// Patches of the keypoints for which `wanted` is set; a keypoint near the border has none.
std::vector<Patch> cut_patches(const ImageOctaves& octaves, const Features& features,
                               const std::vector<bool>& wanted);

/// Octave of the pyramid with ratio 2 that is nearest in size to a pyramid level of `features`.
int octave_of_level(const Features& features, int level);

}  // namespace kinloop
