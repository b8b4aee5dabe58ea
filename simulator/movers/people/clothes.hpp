#pragma once
// In: a seed. Out: clothes, skin and hair, painted.

#include <vector>

#include "kinloop/core/random.hpp"
#include "simulator/paint/texture.hpp"
#include "simulator/render/primitive.hpp"

namespace kinloop::sim {

/// What the parts of a person are covered with.
struct Outfit {
  FaceTexture shirt, trousers, skin, face, hair, shoe, bag;
  bool short_sleeves = false, has_bag = false;
};

/// Paints outfits and keeps their textures.
class Wardrobe {
 public:
  /// `first_texture`: the index that the first of its textures will have.
  explicit Wardrobe(int first_texture) : first_texture_(first_texture) {}

  Outfit outfit(Random& random);

  /// Returns the textures of all outfits, in the order of their indices, and leaves the wardrobe empty.
  std::vector<Texture> release_textures() { return std::move(textures_); }

 private:
  FaceTexture added(const cv::Mat& image, float period_m);

  int first_texture_;
  std::vector<Texture> textures_;
};

}  // namespace kinloop::sim
