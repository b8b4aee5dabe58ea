#pragma once
// The jobs that adjust the map during the run.

#include <memory>
#include <vector>

#include "kinloop/back_end/jobs/job_context.hpp"
#include "kinloop/back_end/self_calibration.hpp"
#include "kinloop/mapping/bundle_adjustment.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

// Local bundle adjustment around each new keyframe.

class LocalBaJob {
 public:
  static constexpr const char* kName = "local bundle adjustment";
  static constexpr bool kMovesWholeMap = false;
  struct Problem {
    BundleAdjustmentProblem problem;
    BundleOptions options;
  };
  using Solution = MapUpdate;

  explicit LocalBaJob(const BackEndOptions& options)
      : options_(options.mapping), lag_frames_(options.executor.local_ba_lag_frames) {}

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& context) const;
  [[nodiscard]] Problem make_problem(const JobContext& context) const;
  [[nodiscard]] static Solution solve(const Problem& problem);
  [[nodiscard]] static std::optional<AppliedSolution> apply(Map& map, const Solution& update);
  void on_stale(const Solution& /*update*/) {}

 private:
  MappingOptions options_;
  int lag_frames_;
};

// Bundle adjustment of the whole map after loops were corrected. Not of a large map, since copying it would
// delay the frame at which the job starts; the final adjustment follows anyway.

class GlobalBaJob {
 public:
  static constexpr const char* kName = "global bundle adjustment";
  static constexpr bool kMovesWholeMap = true;
  struct Problem {
    BundleAdjustmentProblem problem;
    BundleOptions options;
  };
  using Solution = MapUpdate;

  explicit GlobalBaJob(const BackEndOptions& options)
      : options_(options.global_ba),
        enabled_(options.global_ba_enabled),
        max_keyframes_(static_cast<size_t>(options.global_ba_max_keyframes)),
        lag_frames_(options.executor.global_ba_lag_frames) {}

  /// Requests a job. Called after a loop was corrected.
  void request() { requested_ = true; }

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& context) const;
  [[nodiscard]] Problem make_problem(const JobContext& context);
  [[nodiscard]] static Solution solve(const Problem& problem);
  [[nodiscard]] static std::optional<AppliedSolution> apply(Map& map, const Solution& update);
  void on_stale(const Solution& /*update*/) {}

 private:
  BundleOptions options_;
  bool enabled_;
  size_t max_keyframes_;
  int lag_frames_;
  bool requested_ = false;
  size_t min_keyframes_ = 0;  // map size required for the next job
};

// Self-calibration of the sensor times during the run, with the map adjusted to them and its keypoints
// compensated by them. Not in a large map: the times are known by then, and copying it would delay the frame
// at which the job starts.

class SelfCalibrationJob {
 public:
  static constexpr const char* kName = "self-calibration";
  static constexpr bool kMovesWholeMap = true;
  struct Problem {
    BundleAdjustmentProblem problem;
    BundleOptions options;
    std::vector<std::shared_ptr<const Features>> features;  ///< of all keyframes, by id
  };
  struct Solution {
    SelfCalibrationResult result;
    std::vector<std::shared_ptr<const Features>> features;  ///< compensated for the motion by the new times
  };

  /// `nominal` is the sensor of camera.yaml.
  SelfCalibrationJob(const SensorEstimate& nominal, const BackEndOptions& options)
      : enabled_(options.self_calibration.enabled),
        prior_(time_prior(nominal, options.self_calibration)),
        options_(options.global_ba),
        lag_frames_(options.executor.global_ba_lag_frames),
        min_keyframes_(static_cast<size_t>(options.self_calibration.min_keyframes)),
        max_keyframes_(static_cast<size_t>(options.self_calibration.max_keyframes)) {}

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& context) const;
  [[nodiscard]] Problem make_problem(const JobContext& context) const;
  [[nodiscard]] static Solution solve(const Problem& problem);
  [[nodiscard]] std::optional<AppliedSolution> apply(Map& map, const Solution& solution);
  void on_stale(const Solution& /*solution*/) {}

 private:
  bool enabled_;
  SensorPrior prior_;
  BundleOptions options_;
  int lag_frames_;
  size_t min_keyframes_;  // map size required for the next job
  size_t max_keyframes_;
};

}  // namespace kinloop
