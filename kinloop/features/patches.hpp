#pragma once
// Small pieces of an image around its keypoints, from which later frames find the same points again.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "kinloop/features/extraction/image_octaves.hpp"
#include "kinloop/features/features.hpp"

namespace kinloop {

/// A square piece of one octave of an image.
struct Patch {
  static constexpr int kSize = 16;  ///< texels per side

  std::array<uint8_t, kSize * kSize> texels{};  ///< row by row
  Eigen::Vector2f center;  ///< of the keypoint, in texels; (0, 0) is the first texel's centre
  int octave = 0;
};

/// Patches of some of the keypoints of an image. The others take no space: a map keeps these.
class KeypointPatches {
 public:
  /// `patches[k]` is that of the k-th keypoint for which `has_patch` is set.
  KeypointPatches(const std::vector<bool>& has_patch, const std::vector<Patch>& patches);

  /// The same patches in another place in memory.
  KeypointPatches(const KeypointPatches& other, std::shared_ptr<const Patch> storage)
      : index_of_(other.index_of_), patches_(std::move(storage)), patch_count_(other.patch_count_) {}

  /// The patch of a keypoint; null if it has none.
  [[nodiscard]] const Patch* find(size_t keypoint) const {
    const uint32_t index = index_of_[keypoint];
    return index == kNone ? nullptr : patches_.get() + index;
  }
  [[nodiscard]] size_t keypoints() const { return index_of_.size(); }
  [[nodiscard]] std::span<const Patch> patches() const { return {patches_.get(), patch_count_}; }

 private:
  static constexpr uint32_t kNone = UINT32_MAX;

  std::vector<uint32_t> index_of_;  // in patches_, per keypoint
  std::shared_ptr<const Patch> patches_;
  size_t patch_count_ = 0;
};

/// Patches of the keypoints for which `wanted` is set; a keypoint near the border has none.
KeypointPatches cut_patches(const ImageOctaves& octaves, const Features& features,
                            const std::vector<bool>& wanted);

/// Octave of the pyramid with ratio 2 that is nearest in size to a pyramid level of `features`.
int octave_of_level(const Features& features, int level);

}  // namespace kinloop
