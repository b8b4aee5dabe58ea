#pragma once
// The texture of a mesh: one image for all triangles, and where in it each of them is.

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dense/mesh/colored_mesh.hpp"

namespace kinloop {

/// A texture atlas. A vertex at the border of charts has a place in each of them.
struct MeshTexture {
  cv::Mat image;  ///< 8UC3, BGR
  std::vector<Eigen::Vector2f>
      uvs;  ///< places in the image, 0 to 1, from its upper left corner right and down
  std::vector<uint32_t> vertex_of_uv;  ///< index of the vertex that is there
  std::vector<Triangle> triangles;     ///< indices into `uvs`, parallel to the triangles of the mesh

  size_t charts = 0;            ///< connected pieces, each from one view
  size_t unseen_triangles = 0;  ///< no view shows them as a whole: coloured point by point
  double scale = 1;             ///< pixels of the atlas per pixel of the images
};

}  // namespace kinloop
