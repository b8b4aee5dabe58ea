#pragma once
// In: a whole cloud or mesh. Out: what is sent of it to browsers.

#include <vector>

#include "dense/mesh/colored_mesh.hpp"
#include "viewer/scene/wire_format.hpp"

namespace kinloop {

/// Splits a cloud so that every piece is a sample of the whole; thinning then shows no stripes. Points far
/// outside get separate pieces, since the resolution of a piece follows from its size.
std::vector<CloudPiece> split_into_pieces(const ColoredCloud& cloud);

/// Returns a mesh of few triangles that stands in for `mesh` until it has come, and while it takes too long
/// to draw: all vertices in a cell of a cubic grid are replaced by their mean (Rossignac and Borrel 1993),
/// and the triangles that this closes are left out. The grid is just fine enough for at most `max_triangles`.
ColoredMesh coarse_mesh(const ColoredMesh& mesh, size_t max_triangles);

}  // namespace kinloop
