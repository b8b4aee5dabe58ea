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
    std::vector<float> samples_ms;      ///< wall time of each call, per frame or per keyframe
    std::vector<float> cpu_samples_ms;  ///< CPU time of each call
  };
  std::map<std::string, Module> modules;
  std::vector<double> frame_ms;  ///< preparation, tracking and mapping of each frame

  void add(const std::string& module, const ElapsedTime& elapsed) {
    Module& sum = modules[module];
    sum += elapsed;
    sum.samples_ms.push_back(static_cast<float>(1e3 * elapsed.wall_s));
    sum.cpu_samples_ms.push_back(static_cast<float>(1e3 * elapsed.cpu_s));
  }
};

/// Adds the time of its scope to a module.
class ScopedTimer {
 public:
  /// `module` is a literal; `timings` must outlive this object.
  ScopedTimer(Timings& timings, const char* module) : timings_(timings), module_(module) {}
  ~ScopedTimer() { timings_.add(module_, watch_.elapsed()); }
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  Timings& timings_;
  const char* module_;
  Stopwatch watch_;
};

}  // namespace kinloop
