#pragma once
// In: the positions of a pose graph's vertices before and after optimisation. Out: one self-contained HTML
// page with both pictures side by side.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

/// Content of the page.
struct GraphReport {
  std::string title;
  std::string subtitle;
  std::vector<std::pair<std::string, std::string>> tiles;  ///< figure, label
  std::vector<Eigen::Vector3d> before, after;              ///< of each vertex, metres
  std::vector<std::pair<uint32_t, uint32_t>> steps;        ///< vertices connected by odometry
  std::vector<std::pair<uint32_t, uint32_t>> loops;        ///< vertices connected by other edges
};

/// Returns the page; both pictures look along the direction of least extent of the optimised graph.
std::string render_graph_report(const GraphReport& report);

}  // namespace kinloop
