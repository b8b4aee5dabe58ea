#pragma once
// Frames of the simulated room, rendered once and shared by several tests.

#include <string>
#include <vector>

#include "simulator/simulated_source.hpp"

namespace kinloop::test {

/// Frames with the camera and the true poses.
struct Recording {
  RgbdCamera camera;
  Trajectory truth;
  std::vector<Frame> frames;
};

/// The first frames of `scene`, 320 x 240.
inline Recording record_simulation(const std::string& scene, int frames) {
  SimulationOptions options;
  options.frames = frames;
  options.width = 320;
  options.height = 240;
  const auto source = make_simulated_source(scene, options, 2);
  Recording r{source->camera(), source->info().ground_truth, {}};
  while (auto frame = source->next()) r.frames.push_back(*frame);
  return r;
}

}  // namespace kinloop::test
