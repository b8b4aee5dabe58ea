#pragma once
// In: the views that could texture each triangle. Out: the one that does.

#include <cstdint>
#include <vector>

#include "dense/texture/view_candidates.hpp"

namespace kinloop {

/// Stands for a triangle that no view sees.
constexpr uint32_t kNoView = ~uint32_t{0};

/// Two triangles with a common edge.
struct TrianglePair {
  uint32_t first = 0, second = 0;  ///< triangles, first < second
  float edge_m = 0;                ///< length of the edge
};

/// Returns the pairs of triangles with a common edge, in order of their first triangle. Of an edge with more
/// than two triangles each is paired with the next.
std::vector<TrianglePair> adjacent_triangles(const ColoredMesh& mesh);

/// Returns a view for each triangle, or kNoView. The choice minimises what resolution is lost, as the
/// integral over the surface of log (best quality / quality), plus the length of the seams between views
/// times a constant (as Waechter et al., "Let There Be Color!", 2014), approximately, by sequential
/// tree-reweighted message passing (Kolmogorov 2006).
std::vector<uint32_t> choose_views(const ColoredMesh& mesh, const ViewCandidates& candidates);

}  // namespace kinloop
