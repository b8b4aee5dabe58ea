#include "apps/open_source.hpp"

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/sensor/camera_choice.hpp"
#include "kinloop/sensor/tum_source.hpp"

namespace kinloop {

std::unique_ptr<FrameSource> open_source(const std::string& sequence,
                                         const std::optional<std::string>& camera,
                                         const SimulationOptions& simulation, int threads) {
  if (sequence.starts_with("sim:")) {
    if (camera)
      throw UsageError("--camera does not go with a simulated sequence: the simulation brings its own");
    return make_simulated_source(sequence, simulation, threads);
  }
  if (sequence == "kinect1" || sequence == "kinect2" || sequence.ends_with(".bag")) {
    throw UsageError(fmt::format("'{}': this build reads folders in TUM layout and sim:room only", sequence));
  }
  return std::make_unique<TumSource>(sequence, choose_camera(sequence, camera));
}

}  // namespace kinloop
