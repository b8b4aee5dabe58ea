#pragma once
// The one place that knows threads. Slow work is handed in as a function of a copied problem and comes back
// as a JobResult at a frame that depends on the mode, never (but for `live`) on how fast the machine is.

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "kinloop/base/ids.hpp"
#include "kinloop/base/stopwatch.hpp"
#include "kinloop/loop/verify_loop.hpp"
#include "kinloop/slam/dense_keyframe.hpp"
#include "kinloop/slam/options.hpp"
#include "kinloop/slam/self_calibration.hpp"

namespace kinloop {

enum class JobKind {
  kLocalBundleAdjustment,
  kLoopVerification,
  kLoopCorrection,
  kGlobalBundleAdjustment,
  kSelfCalibration,
  kDenseKeyframes
};

/// As reports call it.
const char* to_string(JobKind kind);

/// What slow work gives back.
struct JobResult {
  JobResult() = default;
  JobResult(MapUpdate changes) : update(std::move(changes)) {}  // NOLINT(google-explicit-constructor)
  JobResult(SelfCalibrationResult adjusted)                     // NOLINT(google-explicit-constructor)
      : update(std::move(adjusted.update)), sensor(std::move(adjusted.sensor)) {}

  JobResult(std::vector<VerifiedLoop> verified)  // NOLINT(google-explicit-constructor)
      : loops(std::move(verified)) {}

  JobResult(std::vector<DenseKeyframe> keyframes)  // NOLINT(google-explicit-constructor)
      : dense(std::move(keyframes)) {}

  MapUpdate update;
  std::optional<SensorEstimate> sensor;  ///< where the work estimated it
  std::vector<VerifiedLoop> loops;       ///< where the work verified them
  std::vector<DenseKeyframe> dense;      ///< where the work made them
};

struct FinishedJob {
  JobKind kind = JobKind::kLocalBundleAdjustment;
  JobResult result;
  ElapsedTime elapsed;  ///< on it, for reports
};

class Executor {
 public:
  virtual ~Executor() = default;

  /// Hands in work at frame `now`. At most one job of a kind may be in flight (`busy`).
  virtual void submit(JobKind kind, FrameId now, std::function<JobResult()> work) = 0;

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
