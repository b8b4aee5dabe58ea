#pragma once
// Timings of a run, for reports.

#include <map>
#include <string>
#include <vector>

#include "kinloop/core/stopwatch.hpp"

namespace kinloop {

/// Wall and CPU time [s] per module, and time [ms] per frame.
struct Timings {
  struct Module : ElapsedTime {
    std::vector<double> samples_ms;  ///< wall time of each call, per frame or per keyframe
  };
  std::map<std::string, Module> modules;
  std::vector<double> frame_ms;  ///< `Slam::process` plus the preparation of the frame

  void add(const std::string& module, const ElapsedTime& elapsed) {
    Module& sum = modules[module];
    sum += elapsed;
    sum.samples_ms.push_back(1e3 * elapsed.wall_s);
  }
};

}  // namespace kinloop
