#pragma once
// In: a palette and random numbers. Out: furniture and clutter as groups of solids. A piece stands at z = 0
// with its back at y = 0 and its front towards -y, centred in x.

#include <vector>

#include "simulator/paint/palette.hpp"
#include "simulator/render/primitive.hpp"

namespace kinloop::sim {

using Parts = std::vector<Primitive>;

Primitive make_box(const Eigen::Vector3f& center, const Eigen::Vector3f& size_m,
                   const FaceTexture& face_texture);
Primitive make_cylinder(const Eigen::Vector3f& center, float radius_m, float height_m,
                        const FaceTexture& face_texture);
Primitive make_sphere(const Eigen::Vector3f& center, float radius_m, const FaceTexture& face_texture);
Primitive with_picture(Primitive primitive, int face, const FaceTexture& picture);

Parts moved(Parts parts, float yaw_rad, const Eigen::Vector3f& translation);
Eigen::AlignedBox3f bounds(const Parts& parts);

/// Builds furniture from one palette and one random number stream.
class FurnitureBuilder {
 public:
  FurnitureBuilder(const Palette& palette, Random& random) : palette_(&palette), random_(&random) {}

  Parts desk();
  Parts bookshelf();
  Parts cupboard();
  Parts sofa();
  Parts armchair();
  Parts chair();
  Parts low_table();
  Parts plant();
  Parts floor_lamp();
  Parts carton_stack();
  Parts bin();
  Parts ball();
  Parts radiator();
  Parts wall_shelf();
  /// A framed picture, poster, clock or whiteboard of the given size, with its centre at z = 0.
  Parts wall_picture(float width_m, float height_m);

  /// Everyday objects spread over the rectangle `area` (x, y) at height z.
  Parts clutter(const Eigen::AlignedBox2f& area, float z, float spacing_m);

  float uniform(float low, float high) { return static_cast<float>(random_->uniform(low, high)); }
  bool chance(float probability) { return uniform(0, 1) < probability; }
  [[nodiscard]] const Palette& palette() const { return *palette_; }
  Random& random() { return *random_; }

 private:
  FaceTexture wood() { return palette_->metric(Kind::kWood, 0.8, *random_); }
  FaceTexture plain() { return palette_->metric(Kind::kPlain, 0.3, *random_); }
  FaceTexture metal() { return palette_->metric(Kind::kMetal, 0.3, *random_); }
  FaceTexture fabric() { return palette_->metric(Kind::kFabric, 0.3, *random_); }
  Parts seat(float width_m);
  Parts books(float x0, float x1, float y_front, float z, float max_height_m);
  Parts small_thing();
  Parts book_pile();
  Parts paper_sheets();
  Parts pen_beaker();
  void add_monitor(Parts& parts, float x, float z);

  const Palette* palette_;
  Random* random_;
};

}  // namespace kinloop::sim
