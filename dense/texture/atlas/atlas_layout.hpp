#pragma once
// In: the view of each triangle. Out: where in the texture atlas each triangle is.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "dense/mesh/colored_mesh.hpp"
#include "dense/posed_image.hpp"
#include "dense/texture/choose_views.hpp"

namespace kinloop {

/// Places in a strip.
struct PackedRectangles {
  std::vector<cv::Point> corners;  ///< upper left, in the order of the sizes
  int height = 0;                  ///< of the strip that they take
};

/// Packs rectangles into a strip of this width, which grows downwards: from the highest rectangle on, each
/// goes where its lower side is uppermost ("skyline"; Jylanki, "A Thousand Ways to Pack the Bin", 2010).
/// nullopt if one is wider than the strip.
std::optional<PackedRectangles> pack_rectangles(std::span<const cv::Size> sizes, int width);

/// Width of the border around each chart, which interpolation reaches, pixels.
constexpr int kAtlasMarginPx = 2;

/// Places of charts and of their triangles.
struct AtlasLayout {
  cv::Size size;
  double scale = 1;              ///< pixels of the atlas per pixel of the images
  std::vector<cv::Rect> charts;  ///< with their margins
  std::vector<uint32_t> chart_of_triangle;
  std::vector<Eigen::Vector2f> corners_px;  ///< (0, 0) is the centre of the upper left pixel
  std::vector<uint32_t> vertex_of_corner;
  std::vector<Triangle> triangles;  ///< indices into `corners_px`
};

/// Charts are connected triangles of one view. A chart has the shape that its triangles have in the
/// undistorted image of the view, scaled down where the atlas would exceed `max_size_px`; so its triangles do
/// not overlap. A triangle without a view has a chart of its own, in its plane, as large as from 2 m. Throws
/// UsageError if the atlas is too small even so.
AtlasLayout lay_out_atlas(const ColoredMesh& mesh, std::span<const uint32_t> view_of_triangle,
                          std::span<const PosedImage> views, const PinholeCamera& camera, int max_size_px);

}  // namespace kinloop
