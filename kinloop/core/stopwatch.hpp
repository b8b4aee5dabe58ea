#pragma once
// Wall and CPU time, for reporting only: no decision may depend on them.

#include <chrono>

namespace kinloop {

/// Elapsed time, s.
struct ElapsedTime {
  double wall_s = 0;
  double cpu_s = 0;

  ElapsedTime& operator+=(const ElapsedTime& other) {
    wall_s += other.wall_s;
    cpu_s += other.cpu_s;
    return *this;
  }
};

/// CPU seconds of the calling thread, with those of the threads that `parallel_for` started for it.
double thread_cpu_s();

/// CPU seconds of all threads of the process, since its start.
double process_cpu_s();

/// Adds CPU seconds of another thread to those of the calling thread. Used by `parallel_for`.
void add_worker_cpu_s(double seconds);

/// Measures wall and CPU seconds since its construction; CPU as defined by `thread_cpu_s`.
class Stopwatch {
 public:
  [[nodiscard]] double wall_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start_).count();
  }
  [[nodiscard]] double cpu_s() const { return thread_cpu_s() - cpu_start_s_; }
  [[nodiscard]] ElapsedTime elapsed() const { return {wall_s(), cpu_s()}; }

  /// Returns the elapsed time and starts again from zero.
  ElapsedTime lap() {
    const ElapsedTime time = elapsed();
    *this = Stopwatch();
    return time;
  }

 private:
  std::chrono::steady_clock::time_point wall_start_ = std::chrono::steady_clock::now();
  double cpu_start_s_ = thread_cpu_s();
};

}  // namespace kinloop
