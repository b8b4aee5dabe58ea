#pragma once
// The one place that knows threads. Slow work comes in as an opaque closure, and is complete at a frame that
// depends on the mode, never (but for `live`) on how fast the machine is.

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "kinloop/base/ids.hpp"
#include "kinloop/base/stopwatch.hpp"
#include "kinloop/slam/options.hpp"

namespace kinloop {

/// What is to be done with the result of a job, on the thread that collects it.
using Completion = std::function<void()>;

struct Job {
  std::string_view kind;  ///< as reports call it, a literal; at most one job of a kind is in flight
  int lag_frames = 1;     ///< frames from `submit` until it is due, in lagged mode
  /// Runs on another thread: it may touch nothing that changes meanwhile.
  std::function<Completion()> work;
};

struct FinishedJob {
  std::string_view kind;
  ElapsedTime elapsed;  ///< on its work, for reports
  Completion complete;  ///< for the collector to call, once
};

class Executor {
 public:
  virtual ~Executor() = default;

  /// Hands in a job at frame `now`. Throws std::logic_error while one of its kind is in flight.
  virtual void submit(FrameId now, Job job) = 0;

  /// Whether a job of this kind was handed in and not collected yet.
  [[nodiscard]] virtual bool busy(std::string_view kind) const = 0;

  /// The jobs due at frame `now`, in the order they were handed in; waits for them where the mode says so.
  /// What their work throws is thrown here.
  virtual std::vector<FinishedJob> collect(FrameId now) = 0;

  /// All jobs still outstanding; waits for them.
  virtual std::vector<FinishedJob> drain() = 0;
};

/// The executor that `options.mode` names.
std::unique_ptr<Executor> make_executor(const ExecutorOptions& options);

}  // namespace kinloop
