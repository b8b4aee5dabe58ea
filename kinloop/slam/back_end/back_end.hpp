#pragma once
// Slow work on the map. Says which of it is due, copies its problem out of the map and hands it to the
// executor; applies what comes back.
//
// At most one job of a kind is in flight. A solution is stale where the whole map has moved since its problem
// was copied. One rule for all: it is dropped, and a job of its kind is due again at once if it moves the
// whole map; a local bundle adjustment is not, since the next keyframe brings another.

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "kinloop/slam/back_end/global_ba_job.hpp"
#include "kinloop/slam/back_end/local_ba_job.hpp"
#include "kinloop/slam/back_end/loop_correction_job.hpp"
#include "kinloop/slam/back_end/loop_verification_job.hpp"
#include "kinloop/slam/back_end/self_calibration_job.hpp"
#include "kinloop/slam/executor.hpp"

namespace kinloop {

/// What finished work did.
struct AppliedResults {
  bool map_changed = false;
  std::optional<SensorEstimate> sensor;                           ///< where it was estimated anew
  std::vector<std::pair<std::string_view, ElapsedTime>> elapsed;  ///< per job, whether stale or not
  std::vector<std::string_view> stale;                            ///< kinds of the jobs that were
};

class BackEnd {
 public:
  /// Changes `map` in `apply_due` and `apply_remaining` alone; it must outlive this object.
  BackEnd(Map& map, const RgbdCamera& camera, const SlamOptions& options);
  BackEnd(const BackEnd&) = delete;
  BackEnd& operator=(const BackEnd&) = delete;

  /// Loops that may be there: to be verified, and those that are, put into the map and corrected.
  void add_loop_candidates(LoopCandidates candidates) { verification_.kind.add(std::move(candidates)); }

  /// Hands in what is due at frame `now`.
  void submit(FrameId now, const JobContext& context);

  /// Applies the results that are due at frame `now`.
  AppliedResults apply_due(FrameId now);

  /// Waits for all work, and corrects the loops that none of it has taken in.
  AppliedResults apply_remaining(const JobContext& context);

 private:
  /// A kind of job, and whether the latest was stale and is to be repeated.
  template <class Kind>
  struct Slot {
    Kind kind;
    bool stale = false;
  };

  template <class Kind>
  void submit(Slot<Kind>& slot, FrameId now, const JobContext& context);
  template <class Kind>
  void solve_now(Slot<Kind>& slot, const JobContext& context);
  template <class Kind>
  void apply(Slot<Kind>& slot, typename Kind::Solution solution);
  void complete(const std::vector<FinishedJob>& jobs);
  [[nodiscard]] bool global_correction_in_flight() const;

  Map& map_;
  Slot<LoopVerificationJob> verification_;
  Slot<LoopCorrectionJob> correction_;
  Slot<GlobalBaJob> global_ba_;
  Slot<LocalBaJob> local_ba_;
  Slot<SelfCalibrationJob> self_calibration_;
  AppliedResults results_;              // since they were last given
  bool loops_corrected_ = false;        // by these
  std::unique_ptr<Executor> executor_;  // last: its jobs end first
};

}  // namespace kinloop
