#pragma once
// In: a seed. Out: every texture of a room, by kind.

#include <cstdint>
#include <utility>
#include <vector>

#include "kinloop/core/random.hpp"
#include "simulator/paint/texture.hpp"
#include "simulator/render/primitive.hpp"

namespace kinloop::sim {

enum class Kind {
  kPlaster,
  kAccentWall,
  kFloor,
  kWood,
  kFabric,
  kPlain,
  kMetal,
  kCardboard,
  kLeaf,
  kRug,
  kPicture,
  kWhiteboard,
  kWindowView,
  kPaper,
  kScreen,
  kKeyboard,
  kLabel,
  kSpines,
  kDrawers,
  kDoor,
  kClock,
  kBall,
  kCount
};

/// The textures of one room, several versions of some kinds.
class Palette {
 public:
  Palette(uint64_t seed, int threads);

  /// Returns a version of a kind, fitted to the face it is put on.
  [[nodiscard]] FaceTexture fitted(Kind kind, Random& random) const;

  /// Returns a version of a kind at its natural size (`period_m` metres per repetition), with a random
  /// offset.
  [[nodiscard]] FaceTexture metric(Kind kind, double period_m, Random& random) const;

  /// Returns one cell of an atlas of the kind.
  [[nodiscard]] FaceTexture cell(Kind kind, int columns, int rows, Random& random) const;

  [[nodiscard]] int texture_count() const { return static_cast<int>(textures_.size()); }

  /// Returns the textures, by the indices that face textures hold, and leaves the palette empty.
  std::vector<Texture> release_textures() { return std::move(textures_); }

 private:
  [[nodiscard]] int pick(Kind kind, Random& random) const;

  std::vector<Texture> textures_;
  std::vector<std::vector<int>> versions_;  ///< texture indices by kind
};

}  // namespace kinloop::sim
