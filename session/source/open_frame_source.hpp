#pragma once
// In: the name of a source as the user gives it, and how it is opened. Out: its frames.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "drivers/datasets/camera_selection.hpp"
#include "drivers/live/kinect_options.hpp"
#include "kinloop/sensor/depth_sensor.hpp"
#include "kinloop/sensor/source/frame_source.hpp"
#include "simulator/simulated_source.hpp"

namespace kinloop {

/// What a user says of the camera of a recording; empty or 0: nothing.
struct CameraOptions {
  std::string camera;      ///< a preset or a camera file; of a run also "guess", see guess_camera
  std::string intrinsics;  ///< "fx,fy,cx,cy[,k1,k2,p1,p2,k3]", instead of `camera`
  double depth_scale = 0;  ///< units of the depth images per metre
  std::string sensor;      ///< the depth sensor, a name of option_names(DepthSensorModel)
};

/// The source selected by the user.
struct SourceRequest {
  std::string sequence;  ///< a folder, a recording in one file, sim:room, a camera or a stream
  std::string chosen;  ///< which of several sequences in the folder, see sequence_folder; empty: the only one
  std::optional<CameraArgument> camera;
  bool guess_camera = false;          ///< instead of `camera`: by maps of the first frames, see guess_camera
  std::optional<double> depth_scale;  ///< units of the depth images per metre, of a folder or bag
  std::optional<DepthSensorModel> sensor;  ///< instead of that of the camera file or the recording
  std::optional<std::string> topics;       ///< of a bag, "COLOR,DEPTH[,CAMERA_INFO]"
  double depth_offset_s = 0;   ///< added to the stamps of depth, by which images are then paired anew
  int every = 1;               ///< use only every n-th frame
  std::filesystem::path mask;  ///< image of the pixels to ignore, see MaskedSource; empty: none
  SimulationOptions simulation;
  KinectOptions kinect;
  int threads = 1;
  StopRequest stop = {};  ///< ends a source whose sender or device is silent
};

/// Sets what `options` says. Throws UsageError for intrinsics that are none and sensors that are not known.
void set_camera(SourceRequest& request, const CameraOptions& options);

/// What a source is.
enum class SourceKind {
  kFolder,     ///< images in any layout
  kRecording,  ///< the simulation, or messages or video in one file
  kLive,       ///< a camera or another program, which give each frame once
};

/// Returns what the source is, by its name.
SourceKind source_kind(const std::string& sequence);

/// Opens the source. Throws UsageError or InputError with the remedy.
std::unique_ptr<FrameSource> open_frame_source(const SourceRequest& request);

}  // namespace kinloop
