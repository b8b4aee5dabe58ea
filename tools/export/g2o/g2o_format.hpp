#pragma once
// Keywords of .g2o files, shared by reader and writer.

#include <cstddef>

#include "kinloop/geometry/se2.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Format of a kind of pose.
template <class Pose>
struct G2oFormat;

template <>
struct G2oFormat<SE3> {
  static constexpr const char* kVertex = "VERTEX_SE3:QUAT";
  static constexpr const char* kEdge = "EDGE_SE3:QUAT";
  static constexpr const char* kPrior = "EDGE_SE3_PRIOR";
  static constexpr size_t kNumbers = 7;       // x y z qx qy qz qw
  static constexpr size_t kPriorIndices = 2;  // vertex, parameter
};

template <>
struct G2oFormat<SE2> {
  static constexpr const char* kVertex = "VERTEX_SE2";
  static constexpr const char* kEdge = "EDGE_SE2";
  static constexpr const char* kPrior = "EDGE_PRIOR_SE2";
  static constexpr size_t kNumbers = 3;  // x y angle
  static constexpr size_t kPriorIndices = 1;
};

/// The frame in which an SE3 prior is measured.
inline constexpr const char* kG2oOffsetTag = "PARAMS_SE3OFFSET";

}  // namespace kinloop
