#pragma once
// In: a triangle mesh. Out: one that other programs can work on: manifold, and of fewer triangles. By CGAL,
// an optional dependency.

#include <cstddef>

#include "dense/mesh/colored_mesh.hpp"

namespace kinloop {

/// Returns whether this build has CGAL.
bool mesh_simplification_available();

/// Throws UsageError, which names the options and the remedy, if it has not.
void require_mesh_simplification();

/// Returns the mesh as a manifold with borders, without colours: an edge has at most two triangles, which
/// agree on the free side, and the triangles around a vertex form one fan. Vertices where surfaces only touch
/// are duplicated; triangles that are degenerate or appear twice are left out, and so are pieces that are
/// separate then and have fewer than `min_component_triangles`. Throws UsageError if the build has no CGAL.
ColoredMesh manifold_mesh(const ColoredMesh& mesh, size_t min_component_triangles = 0);

/// Returns such a mesh of at most `max_triangles`, or of as few as its topology allows: the edges whose
/// collapse changes the shape least are collapsed (Lindstrom and Turk 1998). Throws UsageError if the build
/// has no CGAL.
ColoredMesh simplified_mesh(const ColoredMesh& mesh, size_t max_triangles,
                            size_t min_component_triangles = 0);

}  // namespace kinloop
