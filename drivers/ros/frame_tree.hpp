#pragma once
// In: transforms between named coordinate frames (tf). Out: the transform between any two.

#include <map>
#include <optional>
#include <string>

#include "drivers/ros/ros_serialization.hpp"

namespace kinloop {

class FrameTree {
 public:
  /// The first transform of a pair of frames counts.
  void add(const StampedTransform& transform);

  /// Returns T_a_b; nullopt if no chain of transforms connects the frames.
  [[nodiscard]] std::optional<SE3> between(const std::string& a, const std::string& b) const;

 private:
  std::map<std::string, std::map<std::string, SE3>> T_parent_child_;  ///< both directions of each transform
};

}  // namespace kinloop
