#pragma once
// In: trajectories and their errors. Out: a picture of both.

#include <span>
#include <string>

#include "tools/evaluation/evaluate.hpp"

namespace kinloop {

/// An estimate to plot.
struct PlottedEstimate {
  std::string name;
  Trajectory estimate;  ///< in its own world, with the stamps of the truth's clock
  Evaluation evaluation;
};

/// Returns an SVG image: on the left the aligned paths, on the two axes of the truth's world along which it
/// extends most; on the right the errors of the poses over time.
std::string evaluation_plot(std::span<const PlottedEstimate> estimates, const Trajectory& truth);

}  // namespace kinloop
