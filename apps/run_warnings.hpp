#pragma once
// What the result of a run should make its user look at.

#include <string>

#include "apps/run_summary.hpp"
#include "kinloop/dense/options.hpp"
#include "kinloop/slam/listener.hpp"

namespace kinloop {

/// Listens to a run and counts how much of the depth lies where the map takes it.
class DepthWatch : public Listener {
 public:
  explicit DepthWatch(const DenseOptions& options) : min_m_(options.min_m), max_m_(options.max_m) {}

  void on_frame(const FrameResult& result, const PreparedFrame& frame) override;
  void on_map(const Map&) override {}

  /// Of the pixels with depth; 1 where there are none.
  [[nodiscard]] double share_in_range() const;

 private:
  double min_m_, max_m_;
  size_t known_ = 0, in_range_ = 0;
};

/// Warns of a map without points, of depth that is out of range and of ground truth that does not belong to
/// the frames.
void warn_of_result(const RunOutcome& outcome, const Trajectory& trajectory, const DepthWatch& depth);

/// Why the run ended without knowing where the camera is.
std::string loss_text(const Map& map);

}  // namespace kinloop
