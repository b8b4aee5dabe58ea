#pragma once
// In: the places of a pose graph's vertices before and after it was solved. Out: one HTML page with both
// pictures side by side, which needs nothing else: no network, no other file.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

/// What the page shows.
struct GraphReport {
  std::string title;
  std::string subtitle;
  std::vector<std::pair<std::string, std::string>> tiles;  ///< figure, meaning
  std::vector<Eigen::Vector3d> before, after;              ///< of each vertex, metres
  std::vector<std::pair<uint32_t, uint32_t>> steps;        ///< vertices joined by odometry
  std::vector<std::pair<uint32_t, uint32_t>> loops;        ///< vertices joined by all other edges
};

/// The page; both pictures look along the direction in which the solved graph extends least.
std::string render_graph_report(const GraphReport& report);

}  // namespace kinloop
