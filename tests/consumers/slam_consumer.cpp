// A program outside of the project that maps with an installed kinloop.

#include <cstdio>

#include "kinloop/slam/slam.hpp"
#include "simulator/simulated_source.hpp"

int main() {
  kinloop::SimulationOptions options;
  options.frames = 3;
  options.width = 320;
  options.height = 240;
  const auto source = kinloop::make_simulated_source("sim:room", options, 1);
  kinloop::Slam slam(source->camera());
  while (const auto frame = source->next()) slam.process(*frame);
  const size_t poses = slam.finish().size();
  std::printf("%zu poses\n", poses);
  return poses == 3 ? 0 : 1;
}
