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
cv::Mat paint_atlas(const AtlasContent& content, const ImageStore& images, std::span<const PosedImage> views,
                    const DenseCamera& camera, int threads, const Progress& progress = {});

}  // namespace kinloop
