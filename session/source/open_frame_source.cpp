#include "session/source/open_frame_source.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

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
#include "session/input/guess_camera.hpp"
#include "session/source/source_filters.hpp"

namespace kinloop {
namespace {

using Source = std::unique_ptr<FrameSource>;
using OptionalCamera = std::optional<RgbdCamera>;

OptionalCamera camera_given(const SourceRequest& request) {
  return request.camera ? OptionalCamera(given_camera(*request.camera)) : std::nullopt;
}

/// A live camera, by name.
struct LiveCamera {
  std::string_view name;
  Source (*open)(const KinectOptions& options, const OptionalCamera& calibration);
};

constexpr LiveCamera kLiveCameras[] = {{"kinect1", open_kinect1}, {"kinect2", open_kinect2},
                                       {"openni2", open_openni2}, {"realsense", open_realsense},
                                       {"orbbec", open_orbbec},   {"oak", open_oak}};

const LiveCamera* live_camera(const std::string& sequence) {
  const auto* found = std::find_if(std::begin(kLiveCameras), std::end(kLiveCameras),
                                   [&](const LiveCamera& camera) { return camera.name == sequence; });
  return found != std::end(kLiveCameras) ? found : nullptr;
}

bool is_live_camera(const std::string& sequence) {
  return live_camera(sequence) != nullptr;
}

Source open_live_camera(const SourceRequest& request) {
  KinectOptions options = request.kinect;
  options.stop = request.stop;
  return live_camera(request.sequence)->open(options, camera_given(request));
}

bool is_simulation(const std::string& sequence) {
  return sequence.starts_with("sim:");
}

Source open_simulation(const SourceRequest& request) {
  if (request.camera || request.depth_scale)
    throw UsageError(
        "--camera, --intrinsics and --depth-scale cannot be used with a simulated sequence, "
        "which has its own camera");
  return make_simulated_source(request.sequence, request.simulation, request.threads);
}

void require_file(const std::string& path) {
  if (!std::filesystem::exists(path)) throw InputError(fmt::format("{}: no such file; check the path", path));
}

template <auto open>
Source open_file(const SourceRequest& request) {
  const OptionalCamera camera = camera_given(request);
  require_file(request.sequence);
  return open(request.sequence, camera);
}

Source open_bag_recording(const SourceRequest& request) {
  const OptionalCamera camera = camera_given(request);
  require_file(request.sequence);
  const bool has_unit = !request.camera || states_depth_scale(*request.camera);
  return open_bag({request.sequence, camera, has_unit, request.depth_scale, request.topics});
}

Source open_program(const SourceRequest& request) {
  return open_stream(request.sequence, camera_given(request), request.stop);
}

Source open_folder(const SourceRequest& request) {
  auto camera = request.camera;
  if (request.guess_camera)
    camera = guess_camera_aloud(request.sequence, request.depth_scale, request.chosen);
  return open_sequence(request.sequence, camera, request.depth_scale, request.chosen);
}

/// Sources that are told by their name and opened in the same way.
struct SourceFamily {
  SourceKind kind;
  bool states_depth_unit;  ///< always: --depth-scale has no use
  bool (*accepts)(const std::string& sequence);
  Source (*open)(const SourceRequest& request);
};

/// The first that accepts the name.
constexpr SourceFamily kFamilies[] = {
    {SourceKind::kRecording, false, is_simulation, open_simulation},
    {SourceKind::kLive, true, is_live_camera, open_live_camera},
    {SourceKind::kLive, true, is_stream, open_program},
    {SourceKind::kRecording, true, [](const std::string& name) { return name.ends_with(".mkv"); },
     open_file<open_azure_recording>},
    {SourceKind::kRecording, true, [](const std::string& name) { return name.ends_with(".oni"); },
     open_file<open_oni_recording>},
    {SourceKind::kRecording, false, [](const std::string& name) { return is_bag(name); }, open_bag_recording},
    {SourceKind::kFolder, false, [](const std::string&) { return true; }, open_folder},
};

const SourceFamily& family_of(const std::string& sequence) {
  return *std::find_if(std::begin(kFamilies), std::end(kFamilies),
                       [&](const SourceFamily& family) { return family.accepts(sequence); });
}

/// The source as it is.
Source open_as_recorded(const SourceRequest& request) {
  const SourceFamily& family = family_of(request.sequence);
  if (request.guess_camera && family.kind != SourceKind::kFolder)
    throw UsageError(
        "--camera guess: for folders of images; give the camera of other sources with --camera FILE");
  if (!request.chosen.empty() && family.kind != SourceKind::kFolder)
    throw UsageError(fmt::format("--sequence chooses among those of a folder or archive, which {} is not",
                                 request.sequence));
  if (request.depth_scale && family.states_depth_unit)
    throw UsageError(
        fmt::format("--depth-scale is for folders of images and bags; {} states the unit of its depth",
                    request.sequence));
  return family.open(request);
}

DepthSensorModel parse_sensor(const std::string& name) {
  if (const auto model = value_named<DepthSensorModel>(name)) return *model;
  throw UsageError(fmt::format("'{}' is no depth sensor; see docs/cameras.md", name));
}

}  // namespace

void set_camera(SourceRequest& request, const CameraOptions& options) {
  if (!options.camera.empty()) request.camera = options.camera;
  if (!options.intrinsics.empty()) request.camera = parse_intrinsics(options.intrinsics);
  if (options.depth_scale > 0) request.depth_scale = options.depth_scale;
  if (!options.sensor.empty()) request.sensor = parse_sensor(options.sensor);
}

SourceKind source_kind(const std::string& sequence) {
  return family_of(sequence).kind;
}

Source open_frame_source(const SourceRequest& request) {
  auto source = open_as_recorded(request);
  if (request.depth_offset_s != 0)
    source = std::make_unique<ShiftedDepthSource>(std::move(source), request.depth_offset_s);
  if (request.every != 1) source = std::make_unique<ThinnedSource>(std::move(source), request.every);
  if (request.sensor) source = std::make_unique<NamedSensorSource>(std::move(source), *request.sensor);
  if (!request.mask.empty()) source = std::make_unique<MaskedSource>(std::move(source), request.mask);
  return source;
}

}  // namespace kinloop
