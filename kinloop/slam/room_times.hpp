#pragma once
// Where the time goes, for reports.

#include <map>
#include <string>
#include <vector>

#include "kinloop/base/stopwatch.hpp"

namespace kinloop {

/// Wall and CPU seconds per room, and the milliseconds of each frame.
struct RoomTimes {
  struct Spent {
    double wall_s = 0;
    double cpu_s = 0;
    std::vector<double> piece_ms;  ///< wall time of each piece of work, a frame or a keyframe
  };
  std::map<std::string, Spent> rooms;
  std::vector<double> frame_ms;  ///< of `Slam::process`, per frame

  void add(const std::string& room, const Stopwatch& watch) { add(room, watch.wall_s(), watch.cpu_s()); }

  void add(const std::string& room, double wall_s, double cpu_s) {
    Spent& spent = rooms[room];
    spent.wall_s += wall_s;
    spent.cpu_s += cpu_s;
    spent.piece_ms.push_back(1e3 * wall_s);
  }
};

}  // namespace kinloop
