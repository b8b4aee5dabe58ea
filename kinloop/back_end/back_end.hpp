#pragma once
// Schedules slow work on the map: decides which jobs are due, copies their problems out of the map, submits
// them to the executor and applies the results.
//
// At most one job of a kind is in flight. A solution is stale if the whole map has moved since its problem
// was copied. Stale solutions are dropped. The job is then due again at once if it moves the whole map; a
// local bundle adjustment is not repeated, since the next keyframe brings another.

#include <memory>
#include <optional>
#include <string_view>
#include <tuple>
#include <vector>

#include "kinloop/back_end/executor.hpp"
#include "kinloop/back_end/jobs/adjustment_jobs.hpp"
#include "kinloop/back_end/jobs/loop_jobs.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"

namespace kinloop {

/// Effects of the applied results.
struct AppliedResults {
  bool map_changed = false;
  /// If components were parted: T_world_camera of all keyframes before.
  std::vector<SE3> T_world_keyframe_before;
  std::optional<AppliedSensor> sensor;                            ///< set if newly estimated
  std::vector<std::pair<std::string_view, ElapsedTime>> elapsed;  ///< per job, including stale ones
  std::vector<std::string_view> stale;                            ///< kinds of stale jobs
};

/// Holds one slot for each kind of job.
class BackEnd {
 public:
  /// Changes `map` only in `apply_due` and `apply_remaining`. `map` must outlive this object.
  /// `nominal` is the sensor of camera.yaml.
  BackEnd(Map& map, const SensorEstimate& nominal, const BackEndOptions& options, IsAliased is_aliased);
  BackEnd(const BackEnd&) = delete;
  BackEnd& operator=(const BackEnd&) = delete;

  /// Adds loop hypotheses. Those that are verified and agree are added to the map, which is then corrected.
  void add(LoopVerificationProblem hypotheses) { job<LoopVerificationJob>().add(std::move(hypotheses)); }

  /// Says that the camera was falsely located in the component of this keyframe: loops join it later.
  void require_more_evidence(KeyframeId place) { job<LoopDecisionJob>().require_more_evidence(place); }

  /// Records the first keyframe of a component and the last trusted pose before it, see LoopHypotheses.
  void add_beginning(KeyframeId first, const CameraMotion& before) {
    job<LoopDecisionJob>().add_beginning(first, before);
  }

  /// Submits the jobs due at frame `now`.
  void submit(FrameId now, const JobContext& context);

  /// Applies the results that are due at frame `now`.
  AppliedResults apply_due(FrameId now);

  /// Waits for all jobs, applies their results and corrects the remaining loops.
  AppliedResults apply_remaining(const JobContext& context);

  /// The same when no further keyframes come: decides on the loops that wait for them, too.
  AppliedResults apply_last(const JobContext& context);

 private:
  /// A kind of job, and whether its latest result was stale and must be recomputed.
  template <class Kind>
  struct Slot {
    Kind kind;
    bool stale = false;
  };

  template <class Kind>
  [[nodiscard]] Kind& job() {
    return std::get<Slot<Kind>>(slots_).kind;
  }
  template <class Kind>
  void submit(Slot<Kind>& slot, FrameId now, const JobContext& context);
  template <class Kind>
  void solve_now(const JobContext& context);
  template <class Kind>
  void apply(Slot<Kind>& slot, typename Kind::Solution&& solution);
  void solve_remaining(const JobContext& context);
  void take(AppliedSolution applied);
  void complete(const std::vector<FinishedJob>& jobs);
  [[nodiscard]] bool global_correction_in_flight() const;

  Map& map_;
  /// In the order of submission: loop correction before the jobs that wait for it.
  std::tuple<Slot<LoopVerificationJob>, Slot<LoopDecisionJob>, Slot<LoopCorrectionJob>, Slot<JoinCheckJob>,
             Slot<GlobalBaJob>, Slot<LocalBaJob>, Slot<SelfCalibrationJob>>
      slots_;
  AppliedResults results_;              // since they were last returned
  bool loops_corrected_ = false;        // by `results_`
  std::unique_ptr<Executor> executor_;  // last member: its jobs end before the rest is destroyed
};

}  // namespace kinloop
