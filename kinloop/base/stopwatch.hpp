#pragma once
// Wall and CPU time, for reporting only: no decision may depend on them.

#include <chrono>
#include <ctime>

namespace kinloop {

/// Elapsed time, s.
struct ElapsedTime {
  double wall_s = 0;
  double cpu_s = 0;
};

/// Measures wall and own-thread CPU seconds since its construction.
class Stopwatch {
 public:
  [[nodiscard]] double wall_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start_).count();
  }
  [[nodiscard]] double cpu_s() const { return thread_cpu_s() - cpu_start_s_; }
  [[nodiscard]] ElapsedTime elapsed() const { return {wall_s(), cpu_s()}; }

 private:
  static double thread_cpu_s() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }

  std::chrono::steady_clock::time_point wall_start_ = std::chrono::steady_clock::now();
  double cpu_start_s_ = thread_cpu_s();
};

}  // namespace kinloop
