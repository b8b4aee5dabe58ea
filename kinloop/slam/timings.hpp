#pragma once
// Where the time goes, for reports.

#include <map>
#include <string>
#include <vector>

#include "kinloop/base/stopwatch.hpp"

namespace kinloop {

/// Wall and CPU seconds per module, and the milliseconds of each frame.
struct Timings {
  struct Module : ElapsedTime {
    std::vector<double> samples_ms;  ///< wall time of each piece of work, a frame or a keyframe
  };
  std::map<std::string, Module> modules;
  std::vector<double> frame_ms;  ///< of `Slam::process` and of preparing the frame before it

  void add(const std::string& module, const ElapsedTime& elapsed) {
    Module& sum = modules[module];
    sum.wall_s += elapsed.wall_s;
    sum.cpu_s += elapsed.cpu_s;
    sum.samples_ms.push_back(1e3 * elapsed.wall_s);
  }
};

}  // namespace kinloop
