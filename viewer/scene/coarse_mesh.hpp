#pragma once
// In: a mesh. Out: one of few triangles that stands in for it until it has come, and while it takes too long
// to draw.

#include "dense/mesh/colored_mesh.hpp"

namespace kinloop {

/// Returns the mesh with all vertices in a cell of a cubic grid replaced by their mean (Rossignac and Borrel
/// 1993), and without the triangles that this closes. The grid is just fine enough for at most
/// `max_triangles`.
ColoredMesh coarse_mesh(const ColoredMesh& mesh, size_t max_triangles);

}  // namespace kinloop
