#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "python/bindings/dense.hpp"
#include "python/bindings/gil.hpp"
#include "python/bindings/map_file.hpp"
#include "python/bindings/options.hpp"
#include "python/bindings/result.hpp"
#include "session/store/command_files.hpp"
#include "viewer/saved/saved_map.hpp"
#include "viewer/saved/saved_run.hpp"
#include "viewer/saved/shared_page.hpp"
#include "viewer/server/service.hpp"

namespace kinloop::python {
namespace {

/// Serves a run to browsers on this machine.
class PyViewer {
 public:
  PyViewer(SavedRun run, uint16_t port) : run_(std::move(run)) {
    ListenAddress listen;
    listen.port = port;
    listen.framed_by_loopback = true;
    service_ = std::make_unique<ViewerService>(
        listen,
        [this](Scene& scene, size_t) {
          if (!std::exchange(shown_, true)) show_saved_run(scene, run_);
        },
        [](const Command&) {});
    url_ = service_->url();
  }

  [[nodiscard]] const std::string& url() const { return url_; }
  [[nodiscard]] size_t browsers() const { return service_ ? service_->browsers() : 0; }
  /// Called with the GIL, like `browsers`: another thread sees either a running service or none.
  void close() {
    auto ended = std::move(service_);
    without_gil([&] { ended.reset(); });
  }

 private:
  SavedRun run_;
  std::string url_;
  bool shown_ = false;                      // of the service's thread
  std::unique_ptr<ViewerService> service_;  // declared last: its thread uses the others
};

/// Without the GIL.
SavedRun shown_run(Run& run, ColoredCloud cloud, Trajectory path) {
  SavedRun shown;
  shown.name = "Python";
  shown.cloud = std::move(cloud);
  shown.path = std::move(path);
  shown.up = run.up().direction;
  run.with_slam([&](const Slam& slam) { add_map(shown, slam.session_log(), slam.map()); });
  return shown;
}

SavedRun shown_result(const py::object& object) {
  const auto& result = object.cast<const Result&>();
  const py::object cloud = object.attr("cloud");
  return without_gil([&, &points = cloud.cast<const PyCloud&>().cloud] {
    return shown_run(*result.run, points, result.trajectory.poses);
  });
}

/// The map as it is now.
SavedRun shown_slam(Run& run) {
  PythonProgress progress{py::none()};
  SavedRun shown = without_gil([&] {
    return shown_run(run, run.fuse_cloud(progress.function()),
                     run.with_slam([](const Slam& slam) { return slam.trajectory(DoubtfulPoses::kKept); }));
  });
  progress.rethrow();
  return shown;
}

SavedRun shown_map(const py::object& object) {
  auto& map = object.cast<PyMap&>();
  const py::object cloud = object.attr("cloud");
  SavedRun run = without_gil([&] {
    const std::lock_guard lock(map.mutex);
    return saved_run_of(map.open);
  });
  run.name = map.path.string();
  run.cloud = cloud.cast<const PyCloud&>().cloud;
  return run;
}

SavedRun shown_path(const std::filesystem::path& path) {
  PythonProgress progress{py::none()};
  SavedRun run = without_gil([&] { return read_shown(path, progress.function()); });
  progress.rethrow();
  return run;
}

bool is_path(const py::object& what) {
  return py::isinstance<py::str>(what) || py::hasattr(what, "__fspath__");
}

/// What `function` shows.
SavedRun shown(const py::object& what, const char* function) {
  if (py::isinstance<Result>(what)) return shown_result(what);
  if (py::isinstance<PyMap>(what)) return shown_map(what);
  if (py::isinstance<Run>(what)) return shown_slam(what.cast<Run&>());
  if (!is_path(what))
    throw UsageError(fmt::format(
        "{}: expected a Result, a Slam, a Map, or the path of a run's folder, a map file, a cloud or a mesh",
        function));
  return shown_path(what.cast<std::filesystem::path>());
}

std::unique_ptr<PyViewer> view(const py::object& what, uint16_t port) {
  SavedRun run = shown(what, "view");
  return without_gil([&] { return std::make_unique<PyViewer>(std::move(run), port); });
}

/// Where `what` was read; empty for a run in memory.
std::filesystem::path path_of(const py::object& what) {
  if (py::isinstance<PyMap>(what)) return what.cast<const PyMap&>().path;
  return is_path(what) ? what.cast<std::filesystem::path>() : std::filesystem::path();
}

void share(const py::object& what, const std::filesystem::path& file, std::optional<size_t> points,
           double max_size_mb, bool mesh, bool images) {
  SharedPageLimits limits{.bytes = page_bytes("share: max_size_mb", max_size_mb)};
  if (points) limits.points = *points;
  const auto path = path_of(what);
  without_gil([&] {
    CommandFiles files{.outputs = {{"file", file}}};
    add_input(files, path);
    require_outputs(files);
  });
  SavedRun run = shown(what, "share");
  without_gil([&] {
    select_contents(run, mesh, points.has_value(), path);
    std::vector<KeyframeImage> pictures;
    if (images && !path.empty()) pictures = keyframe_images_of(path, run.keyframes, kSharedImages);
    write_file(file, make_shared_page(std::move(run), std::move(pictures), limits).html);
  });
}

}  // namespace

void bind_viewer(py::module_& module) {
  py::class_<PyViewer>(
      module, "Viewer",
      "A page on this machine (127.0.0.1) that shows a map; a notebook shows it in its cell.")
      .def_property_readonly("url", &PyViewer::url, "Address of the page.")
      .def_property_readonly("browsers", &PyViewer::browsers, "Number of browsers connected.")
      .def("close", &PyViewer::close, "Stops serving.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](PyViewer& viewer, const py::args&) { viewer.close(); })
      .def("_repr_html_",
           [](const PyViewer& viewer) {
             return fmt::format(
                 "<iframe src=\"{0}\" width=\"100%\" height=\"600\" style=\"border:0\"></iframe>"
                 "<div><a href=\"{0}\" target=\"_blank\">{0}</a></div>",
                 viewer.url());
           })
      .def("__repr__",
           [](const PyViewer& viewer) { return fmt::format("<kinloop.Viewer: {}>", viewer.url()); });
  module.def("view", &view, py::arg("what"), py::arg("port") = 0, R"(Shows a map in a browser or a notebook.

what: a Result, a Slam (its map as it is now), a Map, or the path of a run's folder, a map file, a cloud or a mesh.
port: 0 = any free one.
Returns a Viewer, which serves until close() or until nothing refers to it. Other machines cannot see it.)");
  module.def("share", &share, py::arg("what"), py::arg("file"), py::kw_only(), py::arg("points") = py::none(),
             py::arg("max_size_mb") = 20.0, py::arg("mesh") = false, py::arg("images") = true,
             R"(Writes a map as one HTML file that opens without kinloop.

what: as for view. points: keep at most this many (default: as many as fit). max_size_mb: largest size, 1 to 100.
mesh: the mesh in the run's folder in place of the cloud, or with it if points is given. images: with the images
of keyframes, which a folder or a map file has. Raises InputError if it is larger even without cloud and images.)");
}

}  // namespace kinloop::python
