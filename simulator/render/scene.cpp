#include "simulator/render/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kinloop::sim {

Scene::Scene(std::vector<Primitive> primitives, std::vector<Texture> textures, std::vector<Light> lights,
             int threads, Movers movers)
    : primitives_(std::move(primitives)),
      textures_(std::move(textures)),
      lights_(std::move(lights)),
      movers_(std::move(movers)),
      bvh_(primitives_),
      light_map_(primitives_, bvh_, lights_, threads) {}

double Scene::distance_to_surface(const Eigen::Vector3d& p_room) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Primitive& primitive : primitives_) {
    nearest = std::min(nearest, std::abs(signed_distance_m(primitive, p_room)));
  }
  return nearest;
}

}  // namespace kinloop::sim
