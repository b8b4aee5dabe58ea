#pragma once
// Checks a run and its result for problems.

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "apps/run/summary/run_summary.hpp"
#include "apps/shared/command_line/commands.hpp"
#include "dense/options.hpp"
#include "dense/up_direction.hpp"
#include "kinloop/slam/listener.hpp"

namespace kinloop {

/// Warns of an up direction that is a guess and unlikely, and says how to give it.
void warn_of_unlikely_up(const UpEstimate& up);

/// Monitors the depth of a run: a wrong depth_scale gives a map without points, or one that is five times too
/// small.
class DepthMonitor : public Listener {
 public:
  /// `depth_scale` is that of the frames, units per metre.
  DepthMonitor(const DenseOptions& options, double depth_scale)
      : limits_(options.limits), scale_(depth_scale) {}

  /// Warns after the first frames. Throws InputError if no camera can have measured such depth.
  void on_frame(const TrackedFrame& tracked) override;
  void on_map(const Map&) override {}

  /// Returns what is wrong with the depth so far, with the remedy; empty if nothing is.
  [[nodiscard]] std::string problem() const;

  /// Returns whether hardly any depth is in the map's range, or most is nearer than cameras measure.
  [[nodiscard]] bool unusable() const;

  /// Returns a common depth_scale that would give a plausible median for indoor scenes, if the current one
  /// does not.
  [[nodiscard]] std::optional<double> plausible_scale() const;

  /// Over the pixels with depth.
  [[nodiscard]] double median_m() const { return quantile_m(0.5); }
  [[nodiscard]] double share_in_range() const;

 private:
  [[nodiscard]] double quantile_m(double q) const;
  [[nodiscard]] bool impossible() const;

  // Histogram of log depth, from 0.1 mm to 100 km in steps of 5 %.
  static constexpr size_t kBins = 425;

  DepthLimits limits_;
  double scale_;
  std::array<size_t, kBins> counts_{};
  size_t frames_ = 0;
  size_t known_ = 0, near_ = 0, far_ = 0;  // pixels with depth, nearer and farther than the range
};

/// Warns of skipped frames, a map without points, implausible depth and ground truth that does not match the
/// frames. Returns false if over half of the frames were skipped, or if the depth or its registration is
/// unusable, and so is the map.
bool check_result(const RunOutcome& outcome, const Trajectory& trajectory, const DepthMonitor& depth);

/// Returns the exit code of a run for scripts: the signal that ended it (0: none), or whether tracking was
/// lost at the end or never started; then it says why and names `details`, a file.
ExitCode exit_code(const Slam& slam, int signal, const std::filesystem::path& details);

}  // namespace kinloop
