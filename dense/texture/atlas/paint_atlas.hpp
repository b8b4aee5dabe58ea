#pragma once
// In: the layout of an atlas, and what each vertex takes from which view. Out: the image of the atlas.

#include <opencv2/core/mat.hpp>

#include "dense/texture/atlas/atlas_layout.hpp"
#include "dense/texture/level_seams.hpp"

namespace kinloop {

/// What is painted.
struct AtlasContent {
  const ColoredMesh& mesh;
  const AtlasLayout& layout;
  std::span<const uint32_t> view_of_triangle;
  const ViewCandidates& candidates;
  const VertexViews& vertex_views;
};

/// Returns the atlas, 8UC3, BGR. A pixel has the colour that its point of the surface has in the views of the
/// triangle's vertices, mixed by the distance from each vertex: inside a chart, in one view; along a seam, in
/// both. A triangle without a view is coloured point by point, as by color_points, and where nothing sees a
/// point, by its vertices. What no chart covers continues the charts around it. Memory: 10 bytes for each
/// pixel of the atlas, and an image for each thread. The result does not depend on `threads`.
cv::Mat paint_atlas(const AtlasContent& content, const StoredViews& stored, int threads,
                    const Progress& progress = {});

/// Shares of the corners of a triangle at a place of its plane in the atlas; outside the triangle some are
/// negative.
class Barycentric {
 public:
  Barycentric(const AtlasLayout& layout, uint32_t triangle) {
    const auto& [a, b, c] = layout.triangles[triangle];
    a_ = layout.corners_px[a];
    const Eigen::Vector2f ab = layout.corners_px[b] - a_, ac = layout.corners_px[c] - a_;
    const float area = ab.x() * ac.y() - ab.y() * ac.x();
    if (area == 0) return;  // everything is the first corner
    to_b_ = Eigen::Vector2f(ac.y(), -ac.x()) / area;
    to_c_ = Eigen::Vector2f(-ab.y(), ab.x()) / area;
  }

  [[nodiscard]] Eigen::Vector3f at(float col, float row) const {
    const Eigen::Vector2f from_a = Eigen::Vector2f(col, row) - a_;
    const float b = to_b_.dot(from_a), c = to_c_.dot(from_a);
    return {1 - b - c, b, c};
  }

 private:
  Eigen::Vector2f a_, to_b_ = Eigen::Vector2f::Zero(), to_c_ = Eigen::Vector2f::Zero();
};

/// The pixels around a triangle.
cv::Rect pixels_around(const AtlasLayout& layout, uint32_t triangle, int margin_px);

/// A pixel that belongs to no triangle.
constexpr int32_t kNobody = -1;

/// Returns the triangle of each pixel, 32SC1: the one that covers it, else one within the margin, else
/// kNobody.
cv::Mat pixel_owners(const AtlasLayout& layout);

/// Calls `use(col, row)` for the pixels around the triangle that belong to it.
template <class Use>
void for_each_pixel(const AtlasLayout& layout, const cv::Mat& owners, uint32_t triangle, const Use& use) {
  const cv::Rect box = pixels_around(layout, triangle, kAtlasMarginPx);
  for (int row = box.y; row < box.br().y; ++row) {
    const auto* owner = owners.ptr<int32_t>(row);
    for (int col = box.x; col < box.br().x; ++col) {
      if (owner[col] == static_cast<int32_t>(triangle)) use(col, row);
    }
  }
}

/// Fills what is not painted with the mean colour around it, from the nearest on (push and pull, Gortler et
/// al. 1996), so that smaller versions of an atlas show no seams. `image` is 8UC3, `painted` 8UC1 of 0 and
/// 255.
void fill_gaps(cv::Mat& image, const cv::Mat& painted);

}  // namespace kinloop
