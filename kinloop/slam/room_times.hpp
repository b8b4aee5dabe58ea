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
  };
  std::map<std::string, Spent> rooms;
  std::vector<double> frame_ms;  ///< of `Slam::process`, per frame

  void add(const std::string& room, const Stopwatch& watch) { add(room, watch.wall_s(), watch.cpu_s()); }

  void add(const std::string& room, double wall_s, double cpu_s) {
    rooms[room].wall_s += wall_s;
    rooms[room].cpu_s += cpu_s;
  }
};

}  // namespace kinloop
