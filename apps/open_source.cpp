#include "apps/open_source.hpp"

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/place/default_vocabulary.hpp"
#include "kinloop/place/vocabulary_file.hpp"
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

Vocabulary open_vocabulary(const std::string& file, const FeatureOptions& features) {
  // It cannot be told from a file what kind of features it was trained on.
  if (!file.empty()) return read_vocabulary(file);
  if (features.kind != "orb") {
    throw UsageError(fmt::format(
        "features.kind={0}: the dictionary built in is of ORB; train one with `kinloop vocab train IMAGES... "
        "--feature {0} -o FILE` and give it with --vocabulary FILE",
        features.kind));
  }
  return load_default_vocabulary();
}

}  // namespace kinloop
