#pragma once
// In: the view of each triangle. Out: how the colours of views are mixed and shifted at each vertex, so that
// no seam is seen.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "dense/texture/view_candidates.hpp"

namespace kinloop {

/// A view whose colour a vertex takes, in equal parts with the others of the vertex.
struct VertexView {
  uint32_t view = 0;
  Eigen::Vector3f offset_bgr = Eigen::Vector3f::Zero();  ///< added to the colours of the view
};

/// The views of each vertex: those of its triangles.
using VertexViews = std::vector<std::vector<VertexView>>;

/// Returns the views of each vertex with offsets that make their colours agree at vertices of several views
/// and change slowly between the vertices of one view (the global adjustment of Lempitsky and Ivanov 2007 and
/// Waechter et al. 2014, by least squares). The colours at a vertex are those of the triangles around it.
VertexViews level_seams(const ColoredMesh& mesh, std::span<const uint32_t> view_of_triangle,
                        const ViewCandidates& candidates);

}  // namespace kinloop
