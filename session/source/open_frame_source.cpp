#include "session/source/open_frame_source.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>

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
#include "kinloop/core/options.hpp"
#include "session/source/source_filters.hpp"

namespace kinloop {

namespace {

using OptionalCamera = std::optional<RgbdCamera>;

/// A live camera, by name.
struct LiveCamera {
  std::string_view name;
  std::unique_ptr<FrameSource> (*open)(const KinectOptions& options, const OptionalCamera& calibration);
};

constexpr LiveCamera kLiveCameras[] = {{"kinect1", open_kinect1}, {"kinect2", open_kinect2},
                                       {"openni2", open_openni2}, {"realsense", open_realsense},
                                       {"orbbec", open_orbbec},   {"oak", open_oak}};

const LiveCamera* live_camera(const std::string& sequence) {
  const auto* found = std::find_if(std::begin(kLiveCameras), std::end(kLiveCameras),
                                   [&](const LiveCamera& camera) { return camera.name == sequence; });
  return found != std::end(kLiveCameras) ? found : nullptr;
}

/// A recording in one file, or in a folder of such files.
struct RecordingFormat {
  bool (*accepts)(const std::filesystem::path& path);  ///< by its name
  std::unique_ptr<FrameSource> (*open)(const SourceRequest& request, const OptionalCamera& camera);
};

constexpr RecordingFormat kRecordingFormats[] = {
    {[](const std::filesystem::path& path) { return path.string().ends_with(".mkv"); },
     [](const SourceRequest& r, const OptionalCamera& camera) {
       return open_azure_recording(r.sequence, camera);
     }},
    {[](const std::filesystem::path& path) { return path.string().ends_with(".oni"); },
     [](const SourceRequest& r, const OptionalCamera& camera) {
       return open_oni_recording(r.sequence, camera);
     }},
    {is_bag, [](const SourceRequest& r, const OptionalCamera& camera) {
       const bool has_unit = !r.camera || states_depth_scale(*r.camera);
       return open_bag({r.sequence, camera, has_unit, r.depth_scale, r.topics});
     }}};

DepthSensorModel parse_sensor(const std::string& name) {
  if (const auto model = value_named<DepthSensorModel>(name)) return *model;
  throw UsageError(fmt::format("'{}' is no depth sensor; see docs/cameras.md", name));
}

const RecordingFormat* recording_format(const std::string& sequence) {
  const auto* found = std::find_if(std::begin(kRecordingFormats), std::end(kRecordingFormats),
                                   [&](const RecordingFormat& format) { return format.accepts(sequence); });
  return found != std::end(kRecordingFormats) ? found : nullptr;
}

bool is_simulation(const std::string& sequence) {
  return sequence.starts_with("sim:");
}

std::unique_ptr<FrameSource> open_simulation(const SourceRequest& request) {
  if (request.camera || request.depth_scale)
    throw UsageError(
        "--camera, --intrinsics and --depth-scale cannot be used with a simulated sequence, "
        "which has its own camera");
  return make_simulated_source(request.sequence, request.simulation, request.threads);
}

KinectOptions live_options(const SourceRequest& request) {
  KinectOptions options = request.kinect;
  options.stop = request.stop;
  return options;
}

std::unique_ptr<FrameSource> open_recording(const RecordingFormat& format, const SourceRequest& request,
                                            const OptionalCamera& camera) {
  if (!std::filesystem::exists(request.sequence))
    throw InputError(fmt::format("{}: no such file; check the path", request.sequence));
  return format.open(request, camera);
}

}  // namespace

void set_camera(SourceRequest& request, const CameraOptions& options) {
  if (!options.camera.empty()) request.camera = options.camera;
  if (!options.intrinsics.empty()) request.camera = parse_intrinsics(options.intrinsics);
  if (options.depth_scale > 0) request.depth_scale = options.depth_scale;
  if (!options.sensor.empty()) request.sensor = parse_sensor(options.sensor);
}

bool is_camera_or_stream(const std::string& sequence) {
  return live_camera(sequence) != nullptr || is_stream(sequence);
}

bool is_recording(const std::string& sequence) {
  return is_simulation(sequence) || recording_format(sequence) != nullptr;
}

namespace {

/// The source as it is.
std::unique_ptr<FrameSource> open_as_recorded(const SourceRequest& request) {
  const std::string& sequence = request.sequence;
  if (is_simulation(sequence)) return open_simulation(request);
  if (!is_camera_or_stream(sequence) && !is_recording(sequence))
    return open_sequence(sequence, request.camera, request.depth_scale);
  if (request.depth_scale && !is_bag(sequence))
    throw UsageError(fmt::format(
        "--depth-scale is for folders of images and bags; {} states the unit of its depth", sequence));
  OptionalCamera camera;
  if (request.camera) camera = given_camera(*request.camera);
  if (const auto* live = live_camera(sequence)) return live->open(live_options(request), camera);
  if (is_stream(sequence)) return open_stream(sequence, camera, request.stop);
  return open_recording(*recording_format(sequence), request, camera);
}

}  // namespace

std::unique_ptr<FrameSource> open_frame_source(const SourceRequest& request) {
  auto source = open_as_recorded(request);
  if (request.depth_offset_s != 0)
    source = std::make_unique<ShiftedDepthSource>(std::move(source), request.depth_offset_s);
  if (request.every != 1) source = std::make_unique<ThinnedSource>(std::move(source), request.every);
  if (request.sensor) source = std::make_unique<NamedSensorSource>(std::move(source), *request.sensor);
  return source;
}

}  // namespace kinloop
