#pragma once

#include <memory>
#include <optional>
#include <string>

#include "kinloop/sensor/frame_source.hpp"
#include "kinloop/sensor/simulation/simulated_source.hpp"

namespace kinloop {

/// Opens what the user named: a folder in TUM layout or sim:room. Throws UsageError or InputError with the
/// remedy.
std::unique_ptr<FrameSource> open_source(const std::string& sequence,
                                         const std::optional<std::string>& camera,
                                         const SimulationOptions& simulation, int threads);

}  // namespace kinloop
