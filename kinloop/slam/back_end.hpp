#pragma once
// Slow work on the map: local adjustment, loop verification and correction, full adjustment,
// self-calibration. Says which of it is due, copies its problem out of the map and hands it to the executor;
// applies what comes back.

#include <memory>
#include <optional>
#include <vector>

#include "kinloop/loop/verify_loop.hpp"
#include "kinloop/slam/executor.hpp"
#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/options.hpp"

namespace kinloop {

/// What finished work did.
struct AppliedResults {
  bool map_changed = false;
  std::optional<SensorEstimate> sensor;  ///< where it was estimated anew
  std::vector<std::pair<JobKind, ElapsedTime>> elapsed;
};

class BackEnd {
 public:
  BackEnd(const RgbdCamera& camera, const SlamOptions& options);

  /// A loop that may be there: to be verified, and if it is, put into the map and corrected.
  void add_loop_candidates(LoopCandidates candidates) {
    if (!candidates.local_maps.empty()) loop_candidates_.push_back(std::move(candidates));
  }

  /// Hands in what is due now that keyframe `newest` was added; one job of a kind at a time.
  void submit(const Map& map, const FrameLog& log, const SensorEstimate& sensor, KeyframeId newest,
              FrameId now);

  /// Applies the results that are due at frame `now`.
  AppliedResults apply_due(Map& map, FrameId now);

  /// Waits for all work, and corrects the loops that none of it has taken in.
  AppliedResults apply_remaining(Map& map);

 private:
  AppliedResults apply(Map& map, const std::vector<FinishedJob>& jobs);
  void add_verified_loops(Map& map, const std::vector<VerifiedLoop>& loops);
  [[nodiscard]] bool global_correction_in_flight() const;
  void requeue_loops(const MapUpdate& stale);
  LoopProblem make_pending_loop_problem(const Map& map);
  void submit_verification(FrameId now);
  void submit_global_correction(const Map& map, FrameId now);
  void submit_local_ba(const Map& map, KeyframeId newest, FrameId now);
  void submit_self_calibration(const Map& map, const FrameLog& log, const SensorEstimate& sensor,
                               FrameId now);

  RgbdCamera camera_;
  SlamOptions options_;
  std::unique_ptr<Executor> executor_;
  std::vector<LoopCandidates> loop_candidates_;            // that wait to be answered
  std::vector<std::pair<LandmarkId, LandmarkId>> merges_;  // of the loops that wait
  bool loop_pending_ = false;                              // a loop edge waits to be worked in
  bool global_ba_pending_ = false;                         // a loop was corrected since the last one
  size_t min_keyframes_for_global_ba_ = 0;                 // that the next full adjustment waits for
  size_t min_keyframes_for_calibration_;                   // that the next self-calibration waits for
};

}  // namespace kinloop
