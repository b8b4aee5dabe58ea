#pragma once
// In: stamps and frames of a sequence. Out: rates, depth range and alignment, as `kinloop probe` prints them.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "kinloop/sensor/frame.hpp"

namespace kinloop {

/// The intervals between frames.
struct RateStatistics {
  double duration_s = 0;
  double median_interval_s = 0;
  double jitter_s = 0;       ///< 95 % of the intervals differ from the median by at most this
  size_t gaps = 0;           ///< intervals longer than 1.5 times the median
  double longest_gap_s = 0;  ///< 0 without gaps
};

/// Returns nullopt for fewer than three stamps.
std::optional<RateStatistics> rate_statistics(std::span<const int64_t> stamps_ns);

/// Quantiles at 5, 50 and 95 %.
struct Spread {
  double low = 0, median = 0, high = 0;
};

Spread spread_of(const std::vector<double>& values);

struct DepthStatistics {
  Spread depth_m;          ///< of the pixels with depth
  double valid_share = 0;  ///< pixels with depth, of all
};

/// Samples a grid of pixels of each frame.
DepthStatistics depth_statistics(std::span<const Frame> frames);

/// Returns the units per metre that would make an impossible median depth plausible indoors, where
/// `depth_scale` is what was assumed; nullopt if the median is possible (0.3 to 20 m) or no usual unit fits.
std::optional<double> plausible_depth_scale(double median_m, double depth_scale);

/// How far depth is shifted against colour.
struct Misregistration {
  Eigen::Vector2d shift_px;  ///< from depth edges to colour edges, x right, y down
  double contrast = 0;       ///< colour gradient at the best shift, relative to the mean over all shifts
};

/// Compares the borders of near objects in depth with the gradients of colour, for all shifts up to 20 px of
/// an image of 640 px. Returns nullopt if there are too few borders or no shift stands out.
std::optional<Misregistration> misregistration(std::span<const Frame> frames);

}  // namespace kinloop
