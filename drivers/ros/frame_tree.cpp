#include "drivers/ros/frame_tree.hpp"

#include <deque>

namespace kinloop {
namespace {

/// tf of ROS 1 wrote "/frame", later versions write "frame".
std::string without_slash(const std::string& frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

}  // namespace

void FrameTree::add(const StampedTransform& transform) {
  const std::string parent = without_slash(transform.header.frame_id), child = without_slash(transform.child);
  T_parent_child_[parent].emplace(child, transform.T_parent_child);
  T_parent_child_[child].emplace(parent, transform.T_parent_child.inverse());
}

std::optional<SE3> FrameTree::between(const std::string& a, const std::string& b) const {
  const std::string start = without_slash(a), goal = without_slash(b);
  std::map<std::string, SE3> T_start = {{start, SE3()}};  // to each frame reached
  std::deque<std::string> open = {start};
  while (!open.empty() && !T_start.contains(goal)) {
    const std::string frame = open.front();
    open.pop_front();
    const auto neighbours = T_parent_child_.find(frame);
    if (neighbours == T_parent_child_.end()) continue;
    for (const auto& [next, T_frame_next] : neighbours->second) {
      if (T_start.emplace(next, T_start.at(frame) * T_frame_next).second) open.push_back(next);
    }
  }
  const auto found = T_start.find(goal);
  return found == T_start.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace kinloop
