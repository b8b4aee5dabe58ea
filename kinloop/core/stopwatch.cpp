#include "kinloop/core/stopwatch.hpp"

#include <ctime>

namespace kinloop {
namespace {

thread_local double worker_cpu_s = 0;

double clock_s(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double thread_cpu_s() {
  return clock_s(CLOCK_THREAD_CPUTIME_ID) + worker_cpu_s;
}

double process_cpu_s() {
  return clock_s(CLOCK_PROCESS_CPUTIME_ID);
}

void add_worker_cpu_s(double seconds) {
  worker_cpu_s += seconds;
}

}  // namespace kinloop
