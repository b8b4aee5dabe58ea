#pragma once
// Runs slow work on background threads, as opaque closures. The frame at which a job is due depends on the
// mode, and only in `live` mode on the speed of the machine.

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "kinloop/back_end/options.hpp"
#include "kinloop/core/ids.hpp"
#include "kinloop/core/stopwatch.hpp"

namespace kinloop {

/// Applies the result of a job. Runs on the thread that collects it.
using Completion = std::function<void()>;

struct Job {
  std::string_view kind;  ///< name in reports, a literal; at most one job of a kind is in flight
  int lag_frames = 1;     ///< frames from `submit` until it is due, in lagged mode
  /// Runs on another thread; must not access data that may change meanwhile.
  std::function<Completion()> work;
};

struct FinishedJob {
  std::string_view kind;
  ElapsedTime elapsed;  ///< time of its work, for reports
  Completion complete;  ///< the collector calls it once
};

class Executor {
 public:
  virtual ~Executor() = default;

  /// Submits a job at frame `now`. Throws std::logic_error while another job of its kind is in flight.
  virtual void submit(FrameId now, Job job) = 0;

  /// Returns whether a job of this kind has been submitted and not yet collected.
  [[nodiscard]] virtual bool busy(std::string_view kind) const = 0;

  /// Returns the jobs due at frame `now` in order of submission; waits for them if the mode requires it.
  /// Rethrows exceptions of their work.
  virtual std::vector<FinishedJob> collect(FrameId now) = 0;

  /// Waits for all outstanding jobs and returns them.
  virtual std::vector<FinishedJob> drain() = 0;
};

/// Returns the executor for `options.mode`.
std::unique_ptr<Executor> make_executor(const ExecutorOptions& options);

}  // namespace kinloop
