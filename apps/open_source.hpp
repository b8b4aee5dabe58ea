#pragma once

#include <memory>
#include <optional>
#include <string>

#include "kinloop/features/options.hpp"
#include "kinloop/place/vocabulary.hpp"
#include "kinloop/sensor/frame_source.hpp"
#include "kinloop/sensor/simulation/simulated_source.hpp"

namespace kinloop {

/// Opens what the user named: a folder in TUM layout or sim:room. Throws UsageError or InputError with the
/// remedy.
std::unique_ptr<FrameSource> open_source(const std::string& sequence,
                                         const std::optional<std::string>& camera,
                                         const SimulationOptions& simulation, int threads);

/// The dictionary in `file`, or where that is empty the one built in. Throws UsageError where that does not
/// go with the features.
Vocabulary open_vocabulary(const std::string& file, const FeatureOptions& features);

}  // namespace kinloop
