#include "session/open_frame_source.hpp"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "drivers/azure/azure_source.hpp"
#include "drivers/datasets/camera_selection.hpp"
#include "drivers/datasets/open_sequence.hpp"
#include "drivers/kinect1/kinect1_source.hpp"
#include "drivers/kinect2/kinect2_source.hpp"
#include "drivers/oak/oak_source.hpp"
#include "drivers/openni2/oni_source.hpp"
#include "drivers/openni2/openni2_source.hpp"
#include "drivers/orbbec/orbbec_source.hpp"
#include "drivers/realsense/realsense_source.hpp"
#include "drivers/ros/bag_source.hpp"
#include "drivers/stream/stream_source.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/place/default_vocabulary.hpp"
#include "kinloop/place/vocabulary_file.hpp"

namespace kinloop {

namespace {

std::optional<RgbdCamera> explicit_camera(const SourceRequest& request) {
  if (!request.camera) return std::nullopt;
  return choose_camera({}, request.camera);
}

bool is_azure_recording(const std::string& sequence) {
  return sequence.ends_with(".mkv");
}

bool is_oni_recording(const std::string& sequence) {
  return sequence.ends_with(".oni");
}

}  // namespace

bool is_camera_or_stream(const std::string& sequence) {
  constexpr std::array kCameras = {"kinect1", "kinect2", "openni2", "realsense", "orbbec", "oak"};
  return std::find(kCameras.begin(), kCameras.end(), sequence) != kCameras.end() || is_stream(sequence);
}

bool is_recording(const std::string& sequence) {
  return sequence.starts_with("sim:") || is_azure_recording(sequence) || is_oni_recording(sequence) ||
         is_bag(sequence);
}

std::unique_ptr<FrameSource> open_frame_source(const SourceRequest& request) {
  const std::string& sequence = request.sequence;
  if (sequence.starts_with("sim:")) {
    if (request.camera)
      throw UsageError("--camera cannot be used with a simulated sequence, which has its own camera");
    return make_simulated_source(sequence, request.simulation, request.threads);
  }
  const auto camera = explicit_camera(request);
  KinectOptions kinect = request.kinect;
  kinect.stop = request.stop;
  if (sequence == "kinect1") return open_kinect1(kinect, camera);
  if (sequence == "kinect2") return open_kinect2(kinect, camera, request.kinect2_frames);
  if (sequence == "openni2") return open_openni2(kinect, camera);
  if (sequence == "realsense") return open_realsense(kinect, camera);
  if (sequence == "orbbec") return open_orbbec(kinect, camera);
  if (sequence == "oak") return open_oak(kinect, camera);
  if (is_stream(sequence)) return open_stream(sequence, camera, request.stop);
  if (!is_recording(sequence)) return open_sequence(sequence, camera);
  if (!std::filesystem::exists(sequence))
    throw InputError(fmt::format("{}: no such file; check the path", sequence));
  if (is_azure_recording(sequence)) return open_azure_recording(sequence, camera);
  if (is_oni_recording(sequence)) return open_oni_recording(sequence, camera);
  return open_bag(sequence, camera, request.topics);
}

Vocabulary open_vocabulary(const std::string& file, const FeatureOptions& features) {
  if (!file.empty()) {
    Vocabulary vocabulary = read_vocabulary(file);
    if (vocabulary.tree().kind == descriptor_kind(features, Metric::kHamming)) return vocabulary;
    throw UsageError(
        fmt::format("{}: a vocabulary of {}, but features.kind={} requires one of 256 bits; "
                    "train it with "
                    "`kinloop vocab train IMAGES... --feature {} -o FILE`",
                    file, vocabulary.descriptors().name, name_of(features.kind), name_of(features.kind)));
  }
  if (features.kind != FeatureKind::kOrb) {
    throw UsageError(
        fmt::format("features.kind={0}: the built-in vocabulary is for ORB; train one with `kinloop vocab "
                    "train IMAGES... "
                    "--feature {0} -o FILE` and pass --vocabulary FILE",
                    name_of(features.kind)));
  }
  return load_default_vocabulary();
}

}  // namespace kinloop
