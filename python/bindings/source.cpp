#include "python/bindings/source.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/camera.hpp"
#include "python/bindings/options.hpp"
#include "python/bindings/stamps.hpp"
#include "python/bindings/trajectory.hpp"
#include "session/plan/run_options.hpp"
#include "session/source/open_frame_source.hpp"

namespace kinloop::python {

Frame PyFrame::raw() const {
  Frame frame = data;
  frame.id.value -= first_frame;
  return frame;
}

SkippedFrames FrameReader::skipped() {
  const std::lock_guard lock(mutex_);
  return skipped_;
}

std::optional<PyFrame> FrameReader::next() {
  const std::lock_guard lock(mutex_);
  if (ended_) return std::nullopt;
  ended_ = true;  // unless there is a frame
  auto frame = read();
  ended_ = !frame;
  if (ended_) pipeline_.reset();
  if (!pipeline_) skipped_ = source_->skipped();
  return frame;
}

std::optional<PyFrame> FrameReader::read() {
  if (pipeline_) {
    auto frame = pipeline_->next();
    if (!frame) return std::nullopt;
    return PyFrame{std::move(*frame), run_, first_frame_, weak_from_this()};
  }
  auto frame = source_->next();
  if (!frame) return std::nullopt;
  PyFrame read{{}, 0, 0, weak_from_this()};
  static_cast<Frame&>(read.data) = std::move(*frame);
  return read;
}

void FrameReader::prepare_for(uint64_t run, const FrontEnd& front_end, bool expects_keypoints) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock() || ended_) return;
  if (!pipeline_) {
    run_ = run;
    first_frame_ = front_end.first_frame();
    pipeline_.emplace(*source_, front_end);
  }
  if (run_ == run) pipeline_->extract_features_ahead(expects_keypoints);
}

namespace {

std::shared_ptr<FrameReader> open_reader(const std::filesystem::path& sequence, const py::object& camera,
                                         const std::optional<std::string>& topics, int threads,
                                         const py::object& options, const py::kwargs& keywords) {
  const RunOptions settings = run_options_with({}, assignments_of(options, keywords));
  SourceRequest request;
  request.sequence = sequence.string();
  if (!camera.is_none()) request.camera = camera_argument(camera, "camera");
  request.topics = topics;
  request.simulation = settings.sim;
  request.kinect = settings.kinect;
  request.threads = threads > 0 ? threads : hardware_threads();
  const py::gil_scoped_release released;
  return std::make_shared<FrameReader>(open_frame_source(request));
}

PyFrame next_frame(FrameReader& reader) {
  const auto read = [&] {
    const py::gil_scoped_release released;
    return reader.next();
  };
  auto frame = read();
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  if (!frame) throw py::stop_iteration();
  return std::move(*frame);
}

py::object ground_truth(const FrameReader& reader) {
  if (reader.info().ground_truth.empty()) return py::none();
  return py::cast(PyTrajectory{reader.info().ground_truth});
}

void bind_frame(py::module_& module) {
  py::class_<PyFrame>(module, "Frame", "A colour image and a depth image of one moment.")
      .def_property_readonly(
          "stamp_s", [](const PyFrame& f) { return seconds_of(f.data.stamp_ns); },
          "Time of the colour image, seconds.")
      .def_property_readonly(
          "stamp_ns", [](const PyFrame& f) { return f.data.stamp_ns; }, "The same in nanoseconds, exact.")
      .def_property_readonly(
          "index", [](const PyFrame& f) { return f.data.id.value - f.first_frame; },
          "Number of the frame in its source, from 0; damaged frames are skipped.")
      .def_property_readonly(
          "rgb", [](const PyFrame& f) { return rgb_view(f.data.color.bgr()); },
          "Colour, uint8 (H, W, 3), red first, read-only. A JPEG is decoded at each access. The last axis "
          "runs backwards "
          "in memory (OpenCV's order): numpy.ascontiguousarray makes a copy where a library needs one.")
      .def_property_readonly(
          "depth_m", [](const PyFrame& f) { return image_view(f.data.depth_m); },
          "Depth along z at each colour pixel, float32 (H, W), metres, 0 = unknown; read-only, not a copy.")
      .def("__repr__", [](const PyFrame& f) {
        return fmt::format("<kinloop.Frame: {} at {} s>", f.data.id.value - f.first_frame,
                           format_stamp(f.data.stamp_ns));
      });
}

}  // namespace

void bind_source(py::module_& module) {
  bind_frame(module);
  py::class_<FrameReader, std::shared_ptr<FrameReader>>(module, "Source",
                                                        R"(The frames of a recording or camera.

Iterate over it once: each frame is a Frame. While Slam.process works on a frame, the next ones are read and prepared on
another thread.)")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &next_frame)
      .def("__len__", [](const FrameReader& r) { return r.info().frames; })
      .def("__bool__", [](const FrameReader&) { return true; })  // a camera has no length
      .def_property_readonly(
          "camera", [](const FrameReader& r) { return r.camera(); }, "The Camera.")
      .def_property_readonly(
          "name", [](const FrameReader& r) { return r.info().name; }, "As given to kinloop.open.")
      .def_property_readonly(
          "live", [](const FrameReader& r) { return r.info().live; },
          "Whether frames arrive in real time and are lost if not taken.")
      .def_property_readonly("ground_truth", &ground_truth, "The true Trajectory; None if there is none.")
      .def_property_readonly(
          "skipped",
          [](FrameReader& reader) {
            std::vector<std::pair<std::string, std::string>> names;
            const SkippedFrames skipped = reader.skipped();
            for (const auto& frame : skipped) names.emplace_back(frame.name, frame.reason);
            if (skipped.size() > names.size())
              names.emplace_back("...", fmt::format("and {} more", skipped.size() - names.size()));
            return names;
          },
          "Frames skipped so far, as (name, reason): the first 100, then one entry that counts the others.")
      .def("__repr__", [](const FrameReader& r) {
        return fmt::format("<kinloop.Source: {}, {} frames>", r.info().name, r.info().frames);
      });
  module.def("open", &open_reader, py::arg("sequence"), py::arg("camera") = py::none(),
             py::arg("topics") = py::none(), py::arg("threads") = 0, py::arg("options") = py::none(),
             R"(Opens a recording or a camera.

sequence: whatever kinloop run takes: a folder in TUM layout or of another dataset, an archive of one, a bag, .mkv, .oni,
  kinect1, ..., sim:room. camera: a Camera, a camera.yaml or a preset instead of the recording's. topics: of a bag,
  "COLOR,DEPTH[,CAMERA_INFO]".
options: kinect.* and sim.* of kinloop run --set: kinloop.open("sim:room", sim={"frames": 100}).
Returns a Source. Raises InputError or UsageError.)");
}

}  // namespace kinloop::python
