#pragma once
// Listens to a run and judges whether its depth can be right: a depth_scale that does not go with the images
// gives a map without points, or one that is five times too small.

#include <array>
#include <optional>
#include <string>

#include "kinloop/dense/options.hpp"
#include "kinloop/slam/listener.hpp"

namespace kinloop {

class DepthMonitor : public Listener {
 public:
  /// `depth_scale` is that of the frames, units per metre.
  DepthMonitor(const DenseOptions& options, double depth_scale) : options_(options), scale_(depth_scale) {}

  /// Warns after the first frames. Throws InputError where no camera can have measured what they hold.
  void on_frame(const FrameResult& result, const PreparedFrame& frame) override;
  void on_map(const Map&) override {}

  /// What is wrong with the depth so far, and the remedy; empty where nothing is.
  [[nodiscard]] std::string problem() const;

  /// Whether hardly any of the depth seen can be in the map, or most is nearer than cameras measure.
  [[nodiscard]] bool unusable() const;

  /// A usual depth_scale that gives the depth a median as in rooms, where the present one does not.
  [[nodiscard]] std::optional<double> plausible_scale() const;

  /// Of the pixels with depth.
  [[nodiscard]] double median_m() const { return quantile_m(0.5); }
  [[nodiscard]] double share_in_range() const;

 private:
  [[nodiscard]] double quantile_m(double q) const;
  [[nodiscard]] bool impossible() const;

  // Depth by its logarithm, from 0.1 mm to 100 km in steps of 5 %.
  static constexpr size_t kBins = 425;

  DenseOptions options_;
  double scale_;
  std::array<size_t, kBins> counts_{};
  size_t frames_ = 0, known_ = 0, near_ = 0,
         far_ = 0;  // frames; pixels with depth, nearer, farther than used
};

}  // namespace kinloop
