#pragma once
// In and out: pose graphs as .g2o text files.
//
// Understood are VERTEX_SE3:QUAT, EDGE_SE3:QUAT, VERTEX_SE2, EDGE_SE2, FIX, and the priors EDGE_PRIOR_SE2 and
// EDGE_SE3_PRIOR (the latter with an identity PARAMS_SE3OFFSET). A file is all in space or all in the plane.
//
// Where the file gives no vertices, they start from poses chained along a spanning tree. An information
// matrix that is not positive semi-definite says that a larger error would be likelier, which no measurement
// can mean: the nearest positive semi-definite matrix (Higham 1988: negative eigenvalues set to zero) stands
// in, and its line is reported.

#include <cstdint>
#include <filesystem>
#include <variant>
#include <vector>

#include "kinloop/optimize/pose_graph/pose_graph.hpp"

namespace kinloop {

/// A .g2o file: its graph, in space or in the plane, and what is needed to write it back.
struct G2oFile {
  std::variant<PoseGraph, PoseGraph2d> graph;
  std::vector<int64_t> ids;  ///< of the vertices in the file; when empty they are their indices
  bool had_vertices = true;  ///< otherwise the poses come from a spanning tree
  /// Lines whose information matrix was not positive semi-definite and has been replaced.
  std::vector<size_t> repaired_lines;
};

/// Reads the file; an edge between successive ids is taken for odometry and marked as trusted. Throws
/// InputError naming file and line for whatever cannot be understood.
G2oFile read_g2o(const std::filesystem::path& path);

/// Writes vertices, then edges, each in their order, atomically and so that reading gives the same numbers.
void write_g2o(const std::filesystem::path& path, const G2oFile& file);

}  // namespace kinloop
