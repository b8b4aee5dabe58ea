#pragma once
// Slow work on the map: local adjustment, loop verification and correction, full adjustment,
// self-calibration. Says which of it is due, copies its problem out of the map and hands it to the executor;
// applies what comes back.

#include <memory>
#include <optional>
#include <vector>

#include "kinloop/loop/close_loop.hpp"
#include "kinloop/slam/executor.hpp"
#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/options.hpp"

namespace kinloop {

/// What finished work did.
struct AppliedWork {
  bool map_changed = false;
  std::optional<SensorEstimate> sensor;  ///< where it was estimated anew
  std::vector<std::pair<JobKind, Spent>> spent;
};

class MapWork {
 public:
  MapWork(const RgbdCamera& camera, const SlamOptions& options);

  /// A loop that may be there: to be verified, and if it is, put into the map and corrected.
  void note_possible_loop(LoopQuestion question) {
    if (!question.places.empty()) questions_.push_back(std::move(question));
  }

  /// Hands in what is due now that keyframe `newest` was added; one job of a kind at a time.
  void submit(const Map& map, const FrameLog& log, const SensorEstimate& sensor, KeyframeId newest,
              FrameId now);

  /// Applies the results that are due at frame `now`.
  AppliedWork apply_due(Map& map, FrameId now);

  /// Waits for all work, and corrects the loops that none of it has taken in.
  AppliedWork apply_rest(Map& map);

 private:
  AppliedWork apply(Map& map, const std::vector<FinishedJob>& jobs);
  void take_loops(Map& map, const std::vector<LoopAnswer>& answers);
  [[nodiscard]] bool bending() const;
  void return_loops(const MapUpdate& stale);
  LoopProblem take_loop_problem(const Map& map);
  void submit_verification(FrameId now);
  void submit_bending(const Map& map, FrameId now);
  void submit_local(const Map& map, KeyframeId newest, FrameId now);
  void submit_calibration(const Map& map, const FrameLog& log, const SensorEstimate& sensor, FrameId now);

  RgbdCamera camera_;
  SlamOptions options_;
  std::unique_ptr<Executor> executor_;
  std::vector<LoopQuestion> questions_;                    // that wait to be answered
  std::vector<std::pair<LandmarkId, LandmarkId>> merges_;  // of the loops that wait
  bool loop_pending_ = false;                              // a loop edge waits to be worked in
  bool full_adjustment_pending_ = false;                   // a loop was corrected since the last one
  size_t keyframes_to_adjust_ = 0;                         // that the next full adjustment waits for
  size_t keyframes_to_calibrate_;                          // that the next self-calibration waits for
};

}  // namespace kinloop
