#pragma once
// Reads and writes pose graphs as .g2o text files.
//
// Supports VERTEX_SE3:QUAT, EDGE_SE3:QUAT, VERTEX_SE2, EDGE_SE2, FIX, and the priors EDGE_PRIOR_SE2 and
// EDGE_SE3_PRIOR (the latter with an identity PARAMS_SE3OFFSET). A file must not mix 2D and 3D.
//
// If the file has no vertices, their poses are chained along a spanning tree. An information matrix that is
// not positive semi-definite is invalid. It is replaced by the nearest positive semi-definite matrix (Higham
// 1988: negative eigenvalues set to zero), and its line is reported.

#include <cstdint>
#include <filesystem>
#include <variant>
#include <vector>

#include "kinloop/optimize/pose_graph/pose_graph.hpp"

namespace kinloop {

/// Content of a .g2o file: a 3D or 2D graph and what is needed to write it back.
struct G2oFile {
  std::variant<PoseGraph, PoseGraph2d> graph;
  std::vector<int64_t> ids;  ///< vertex ids in the file; if empty, the indices
  bool had_vertices = true;  ///< otherwise the poses come from a spanning tree
  /// Lines whose information matrix was not positive semi-definite and was replaced.
  std::vector<size_t> repaired_lines;
};

/// Reads the file. Edges between successive ids are assumed to be odometry and marked so. Throws
/// InputError with file and line for invalid content.
G2oFile read_g2o(const std::filesystem::path& path);

/// Writes vertices, then edges, in order, atomically, with enough digits to read back identical numbers.
void write_g2o(const std::filesystem::path& path, const G2oFile& file);

}  // namespace kinloop
