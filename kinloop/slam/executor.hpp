#pragma once
// The one place that knows threads. Slow work is handed in as a function of a copied problem and comes back
// as a MapUpdate at a frame that depends on the mode, never (but for `live`) on how fast the machine is.

#include <functional>
#include <memory>
#include <vector>

#include "kinloop/base/ids.hpp"
#include "kinloop/map/map_update.hpp"
#include "kinloop/slam/options.hpp"

namespace kinloop {

enum class JobKind { kLocalAdjustment, kLoopCorrection, kFullAdjustment };

struct FinishedJob {
  JobKind kind = JobKind::kLocalAdjustment;
  MapUpdate update;
};

class Executor {
 public:
  virtual ~Executor() = default;

  /// Hands in work at frame `now`. At most one job of a kind may be in flight (`busy`).
  virtual void submit(JobKind kind, FrameId now, std::function<MapUpdate()> work) = 0;

  /// Whether a job of this kind was handed in and not collected yet.
  [[nodiscard]] virtual bool busy(JobKind kind) const = 0;

  /// The results due at frame `now`, in the order they were handed in; waits for them where the mode says so.
  virtual std::vector<FinishedJob> collect(FrameId now) = 0;

  /// All results still outstanding; waits for them.
  virtual std::vector<FinishedJob> drain() = 0;
};

/// The executor that `options.mode` names.
std::unique_ptr<Executor> make_executor(const ExecutorOptions& options);

}  // namespace kinloop
