#include "kinloop/core/threads/parallel_for.hpp"

#include <algorithm>
#include <exception>
#include <numeric>
#include <thread>
#include <vector>

#include "kinloop/core/stopwatch.hpp"

namespace kinloop {

void parallel_for(size_t count, int threads, const std::function<void(size_t, size_t)>& body) {
  const size_t pieces =
      std::clamp<size_t>(static_cast<size_t>(std::max(threads, 1)), 1, std::max<size_t>(count, 1));
  if (count == 0) return;
  if (pieces == 1) return body(0, count);

  std::vector<std::exception_ptr> errors(pieces);
  std::vector<double> cpu_s(pieces);  // of the workers
  const auto run_piece = [&](size_t piece) {
    try {
      body(count * piece / pieces, count * (piece + 1) / pieces);
    } catch (...) {
      errors[piece] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> workers;
    for (size_t piece = 1; piece < pieces; ++piece) {
      workers.emplace_back([&, piece] {
        run_piece(piece);
        cpu_s[piece] = thread_cpu_s();
      });
    }
    run_piece(0);
  }
  add_worker_cpu_s(std::accumulate(cpu_s.begin(), cpu_s.end(), 0.0));
  for (const auto& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

int hardware_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace kinloop
