#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "kinloop/core/errors.hpp"
#include "python/bindings/array_frame.hpp"
#include "python/bindings/camera.hpp"
#include "python/bindings/gil.hpp"
#include "python/bindings/options.hpp"
#include "python/bindings/result.hpp"
#include "python/bindings/stamps.hpp"
#include "python/bindings/trajectory.hpp"

namespace kinloop::python {
namespace {

std::shared_ptr<Run> make_run(const py::object& camera, const py::object& options,
                              const std::optional<std::filesystem::path>& load_map, bool localize,
                              const std::optional<std::filesystem::path>& vocabulary, int threads,
                              const py::kwargs& keywords) {
  const RgbdCamera calibration = camera_argument(camera, "camera");
  RunSettings settings;
  settings.assignments = assignments_of(options, keywords);
  if (load_map) settings.load_map = *load_map;
  if (vocabulary) settings.vocabulary = vocabulary->string();
  settings.localize = localize;
  settings.threads = threads;
  return without_gil([&] {
    // Its threads may need the GIL for their last images.
    return std::shared_ptr<Run>(new Run(calibration, settings), [](Run* run) {
      if (PyGILState_Check() == 0) return delete run;
      const py::gil_scoped_release released;
      delete run;
    });
  });
}

/// T_world_camera, or None while tracking is lost.
py::object pose_of(const TrackedFrame& result) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  if (result.is_lost()) return py::none();
  return py::cast(result.T_world_camera.matrix());
}

// What is done with a frame.
constexpr auto kProcess = [](Run& run, const auto& given) { return run.process(given); };
constexpr auto kTrack = [](Run& run, const auto& given) { return run.track(given); };

template <auto kStep>
py::object take_frame(Run& run, const PyFrame& frame) {
  return pose_of(without_gil([&] { return kStep(run, frame); }));
}

using Mask = py::array_t<uint8_t, py::array::c_style | py::array::forcecast>;  // also of bool

cv::Mat mask_of(const Mask& mask, const PinholeCamera& camera) {
  if (mask.ndim() != 2 || mask.shape(0) != camera.height || mask.shape(1) != camera.width)
    throw UsageError(
        fmt::format("mask: must be an array of {} x {}, as the image, 0 or False where it is to be ignored",
                    camera.height, camera.width));
  cv::Mat copy(camera.height, camera.width, CV_8UC1);
  std::copy_n(mask.data(), copy.total(), copy.data);
  return copy;
}

template <auto kStep>
py::object take_arrays(Run& run, double stamp_s, const py::array& rgb, const py::array& depth,
                       std::optional<double> depth_scale, std::optional<double> depth_stamp_s,
                       const std::optional<Mask>& mask, bool copy) {
  const RgbdCamera& camera = run.camera();
  const double scale = depth_scale.value_or(camera.depth_scale);
  if (!(scale > 0)) throw UsageError(fmt::format("depth_scale: {} is not a positive number", scale));
  const int64_t stamp_ns = stamp_ns_of(stamp_s);
  ArrayFrame frame = frame_of_arrays(rgb, depth, camera, {scale, copy});
  frame.stamp_ns = stamp_ns;
  if (depth_stamp_s) frame.depth_stamp_ns = stamp_ns_of(*depth_stamp_s);
  if (mask) frame.mask = mask_of(*mask, camera.color);
  return pose_of(without_gil([&] { return kStep(run, std::exchange(frame, {})); }));
}

std::unique_ptr<Result> finish(const std::shared_ptr<Run>& run, const py::object& progress,
                               bool keep_doubtful) {
  const auto doubtful = keep_doubtful ? DoubtfulPoses::kKept : DoubtfulPoses::kLeftOut;
  PythonProgress reporter(progress);
  auto trajectory = without_gil([&] {
    run->finish(reporter.function());
    return run->with_slam([&](const Slam& slam) { return slam.trajectory(doubtful); });
  });
  reporter.rethrow();
  return std::make_unique<Result>(Result{run, {std::move(trajectory)}, doubtful, py::none()});
}

template <class Read>
auto reading(const Read& read) {
  return [read](Run& run) { return without_gil([&] { return run.with_slam(read); }); };
}

/// The last frame; null if it was lost or there was none.
const EstimatedFrame* last_located(const Slam& slam) {
  const EstimatedFrame* last = slam.latest();
  return last == nullptr || last->is_lost() ? nullptr : last;
}

bool is_lost(const Slam& slam) {
  return last_located(slam) == nullptr;
}

bool is_doubtful(const Slam& slam) {
  const EstimatedFrame* last = last_located(slam);
  return last != nullptr && last->is_doubtful();
}

py::object last_T_map_odom(Run& run) {
  const SE3 T =
      without_gil([&] { return run.with_slam([](const Slam& slam) { return slam.T_map_odom(); }); });
  return py::cast(T.matrix());
}

double last_sigma_m(const Slam& slam) {
  const EstimatedFrame* last = last_located(slam);
  return last == nullptr ? 0 : position_sigma_m(last->world_covariance);
}

Matrix6d last_covariance(const Slam& slam) {
  const EstimatedFrame* last = last_located(slam);
  return last == nullptr ? Matrix6d(Matrix6d::Zero()) : last->world_covariance;
}

}  // namespace

void bind_slam(py::module_& module) {
  py::class_<Run, std::shared_ptr<Run>>(module, "Slam", R"(Tracks a camera and maps what it sees.

Slam(camera, options=None, *, load_map=None, localize=False, vocabulary=None, threads=0, **options)

camera: a Camera, the name of a preset, or the path of a camera.yaml.
options: those of kinloop run --set (kinloop run --options lists them), as a dict or as keywords. Groups are nested:
  Slam(camera, seed=2, features={"count": 800}) or Slam(camera, {"seed": 2, "features.count": 800}).
load_map: a map file, or the folder of a run, to continue; the poses are in its world.
localize: only locate the camera in that map and do not change it.
vocabulary: a file of kinloop.Vocabulary (default: built-in). threads: 0 = all; the result does not depend on it.

Raises UsageError for an unknown or bad option and InputError for a file that cannot be used, as the program does.
The world is the first camera: x right, y down, z forward, metres.)")
      .def(py::init(&make_run), py::arg("camera"), py::arg("options") = py::none(), py::kw_only(),
           py::arg("load_map") = py::none(), py::arg("localize") = false, py::arg("vocabulary") = py::none(),
           py::arg("threads") = 0)
      .def("process", &take_frame<kProcess>, py::arg("frame"), R"(Processes the next frame.

process(frame): a Frame of kinloop.open.
process(stamp_s, rgb, depth, *, depth_scale=None, depth_stamp_s=None, mask=None, copy=True): arrays.
  stamp_s: seconds, must increase; kept to the microsecond.
  rgb: uint8 (H, W, 3), red first.
  depth: along z at each colour pixel, 0 = unknown; float32 (H, W) in metres, or uint16 (H, W) with depth_scale units
    per metre (default: the camera's). If the camera has a depth camera of its own, depth is as that one sees it.
  depth_stamp_s: time of depth, if it differs from that of colour.
  mask: (H, W), 0 or False where the images are to be ignored, for example where people are.
  copy: False shares the memory of float32 depth, if it is aligned and finite, and of rgb that is a reversed view of BGR
    (bgr[:, :, ::-1]), and keeps the arrays alive. They must not change before finish(): a buffer that a camera fills
    again needs copy=True.

Returns T_world_camera, float64 (4, 4), metres; None while tracking is lost. Later corrections of the map do not change
poses already returned: finish() returns the final ones. The GIL is released.)")
      .def("process", &take_arrays<kProcess>, py::arg("stamp_s"), py::arg("rgb"), py::arg("depth"),
           py::kw_only(), py::arg("depth_scale") = py::none(), py::arg("depth_stamp_s") = py::none(),
           py::arg("mask") = py::none(), py::arg("copy") = true)
      .def("track", &take_frame<kTrack>, py::arg("frame"),
           R"(The first part of process, with the same arguments: returns the pose as soon as it is known.

Call update_map() when the pose has been used; otherwise the next call does that first.)")
      .def("track", &take_arrays<kTrack>, py::arg("stamp_s"), py::arg("rgb"), py::arg("depth"), py::kw_only(),
           py::arg("depth_scale") = py::none(), py::arg("depth_stamp_s") = py::none(),
           py::arg("mask") = py::none(), py::arg("copy") = true)
      .def(
          "update_map", [](Run& run) { return pose_of(without_gil([&] { return run.update_map(); })); },
          R"(The second part of process: adds the frame of the last track() to the map.

It takes longest where the frame becomes a keyframe. Returns T_world_camera as it is then; None if it is lost.)")
      .def("finish", &finish, py::arg("progress") = py::none(), py::kw_only(),
           py::arg("keep_doubtful") = false,
           R"(Ends the run: adjusts the whole map and every frame.

progress: called as progress(stage, done, total); return False to stop early with the result so far.
keep_doubtful: whether the trajectory of the Result includes the poses of doubtful frames.
Returns a Result.)")
      .def_property_readonly(
          "warnings", &warnings_of,
          "Where the frames so far contradict themselves or the camera, as Result.warnings; "
          "finish() may add to them.")
      .def_property_readonly("lost", reading(&is_lost),
                             "Whether the last frame could not be located, or there was none.")
      .def_property_readonly("doubtful", reading(&is_doubtful),
                             "Whether the evidence for the last pose is too weak to trust it.")
      .def_property_readonly(
          "position_sigma_m", reading(&last_sigma_m),
          "The standard deviation of the last position, relative to the first keyframe, along its "
          "least certain direction, metres; 0 if unknown.")
      .def_property_readonly(
          "covariance", reading(&last_covariance),
          "The covariance of the last pose relative to the first keyframe, float64 (6, 6): of "
          "translation (m) and rotation (rad) in camera axes; zero if unknown.")
      .def_property_readonly(
          "T_map_odom", &last_T_map_odom,
          "Where the frame of the odometry is in the map as of the last frame, float64 (4, 4), metres: "
          "inv(T_map_odom) @ T_world_camera does not jump when the map is corrected or a place recognized "
          "(REP 105).")
      .def_property_readonly("keyframes",
                             reading([](const Slam& slam) { return slam.map().keyframes().size(); }),
                             "Number of keyframes.")
      .def_property_readonly("landmarks",
                             reading([](const Slam& slam) { return slam.map().landmark_count(); }),
                             "Number of landmarks.")
      .def_property_readonly("loops",
                             reading([](const Slam& slam) { return slam.map().loop_closures().size(); }),
                             "Number of loops closed.")
      .def_property_readonly("trajectory",
                             reading([](const Slam& slam) { return PyTrajectory{slam.trajectory()}; }),
                             "The Trajectory so far, with all corrections of the map, without doubtful "
                             "poses.");
}

}  // namespace kinloop::python
