#pragma once
// Where the time goes, for reports.

#include <map>
#include <string>
#include <vector>

#include "kinloop/base/stopwatch.hpp"

namespace kinloop {

/// Wall and CPU seconds per room, and the milliseconds of each frame.
struct RoomTimes {
  struct Room : Spent {
    std::vector<double> piece_ms;  ///< wall time of each piece of work, a frame or a keyframe
  };
  std::map<std::string, Room> rooms;
  std::vector<double> frame_ms;  ///< of `Slam::process` and of preparing the frame before it

  void add(const std::string& room, const Spent& spent) {
    Room& sum = rooms[room];
    sum.wall_s += spent.wall_s;
    sum.cpu_s += spent.cpu_s;
    sum.piece_ms.push_back(1e3 * spent.wall_s);
  }
};

}  // namespace kinloop
