#pragma once
// Values in the rows of a map file, with the ranges outside of which they are damage. A file may have right
// checksums and come from anywhere.

#include <cstdint>
#include <limits>

#include "kinloop/geometry/se3.hpp"
#include "kinloop/io/map_file/checked_database.hpp"
#include "kinloop/map/keyframe.hpp"

namespace kinloop {

constexpr int64_t kMaxKeyframes = 1 << 24;        ///< five in a second for 38 days
constexpr int64_t kMaxFrames = int64_t{1} << 31;  ///< 30 in a second for two years
constexpr int64_t kMaxRows = int64_t{1} << 32;
constexpr int64_t kMaxInliers = 1 << 24;
constexpr int64_t kMaxStatus = 255;
constexpr int64_t kMaxSide_px = 1 << 15;
constexpr double kMaxDistanceM = 1e6;
constexpr double kMaxLagS = 1e3;
constexpr double kMaxScale = 1e3;      ///< of one visit relative to another
constexpr double kMaxParameter = 1e6;  ///< of a sensor, in its own unit
constexpr double kUnconstrained =
    std::numeric_limits<double>::infinity();  ///< standard deviation of such a parameter

/// Reads a number from 0 to `limit` - 1.
uint32_t take_index(RowReader& row, int64_t limit);

/// Reads the id of a keyframe, which may be the invalid one.
KeyframeId take_keyframe(RowReader& row);

/// Reads a time stamp. The difference of two of them does not overflow.
int64_t take_stamp(RowReader& row);

/// Reads a rigid motion.
SE3 take_pose(RowReader& row);

/// Returns whether a matrix is the information of an estimate: finite, symmetric, positive semi-definite.
bool is_information(const Matrix6d& matrix);

}  // namespace kinloop
