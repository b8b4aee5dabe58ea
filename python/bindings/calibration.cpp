#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/gil.hpp"
#include "python/bindings/options.hpp"
#include "tools/calibration/board/find_board.hpp"
#include "tools/calibration/lens.hpp"

namespace kinloop::python {
namespace {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

Points to_rows(const std::vector<Eigen::Vector2d>& points) {
  Points rows(static_cast<long>(points.size()), 2);
  for (size_t i = 0; i < points.size(); ++i) rows.row(static_cast<long>(i)) = points[i].transpose();
  return rows;
}

std::vector<Eigen::Vector2d> to_points(const Points& rows) {
  std::vector<Eigen::Vector2d> points;
  for (long i = 0; i < rows.rows(); ++i) points.emplace_back(rows.row(i).transpose());
  return points;
}

BoardView make_view(const Points& board_m, const Points& pixels, std::pair<int, int> size,
                    const std::string& name) {
  if (board_m.rows() != pixels.rows() || board_m.rows() < 4)
    throw UsageError(
        fmt::format("BoardView: {} points on the board and {} pixels; expected at least four of both",
                    board_m.rows(), pixels.rows()));
  return {name, size.first, size.second, to_points(board_m), to_points(pixels)};
}

std::optional<BoardView> find_in_image(const py::array& image, const std::string& board, double square_m,
                                       double marker_m, const std::string& name) {
  const cv::Mat gray = gray_image(image, "image");
  const Board wanted = parse_board(board, square_m, marker_m);
  auto view = without_gil([&] { return kinloop::find_board(gray, wanted); });
  if (view) view->name = name;
  return view;
}

LensCalibration calibrate_views(const std::vector<BoardView>& views, const py::kwargs& keywords) {
  const auto options = with_assignments(CalibrationOptions{}, assignments_of(keywords));
  check_options(options);
  return without_gil([&] { return calibrate_lens(views, options); });
}

LensCalibration calibrate_folder(const std::filesystem::path& folder, const std::string& board,
                                 double square_m, double marker_m, const py::object& progress,
                                 const py::kwargs& keywords) {
  const Board wanted = parse_board(board, square_m, marker_m);
  const auto options = with_assignments(CalibrationOptions{}, assignments_of(keywords));
  check_options(options);
  PythonProgress reporter(progress);
  auto calibration = without_gil([&] {
    const auto search = find_boards(list_stills(folder), wanted, hardware_threads(), reporter.function());
    return calibrate_lens(search.views, options);
  });
  reporter.rethrow();
  return calibration;
}

RgbdCamera camera_of_calibration(const LensCalibration& calibration, double depth_scale, double fps) {
  RgbdCamera camera;
  camera.color = calibration.camera;
  camera.depth_scale = depth_scale;
  camera.fps = fps;
  return camera;
}

py::dict deviations_of(const LensCalibration& calibration) {
  py::dict named;
  const auto deviations = calibration.std_deviations();
  for (int i = 0; i < kLensParameters; ++i) named[kLensParameterNames[i]] = deviations[i];
  return named;
}

template <class View>
py::dict by_name(const std::vector<View>& views) {
  py::dict named;
  for (const View& view : views) {
    if constexpr (std::is_same_v<View, RejectedView>) {
      named[py::str(view.name)] = view.reason;
    } else {
      named[py::str(view.view.name)] = view.rms_px;
    }
  }
  return named;
}

void bind_calibration_result(py::module_& module) {
  py::class_<LensCalibration>(module, "Calibration",
                              "A calibrated camera, its uncertainty and the views used.")
      .def("camera", &camera_of_calibration, py::arg("depth_scale") = RgbdCamera().depth_scale,
           py::arg("fps") = RgbdCamera().fps, "Returns the Camera; its save() writes camera.yaml.")
      .def_readonly("rms_px", &LensCalibration::rms_px,
                    "Root mean square of the reprojection errors, px, as OpenCV's.")
      .def_property_readonly("deviations", &deviations_of,
                             "Standard deviation of each parameter by name: fx, fy, k1, ...")
      .def_property_readonly(
          "views", [](const LensCalibration& c) { return by_name(c.views); },
          "Error of each view used, px, by name.")
      .def_property_readonly(
          "rejected", [](const LensCalibration& c) { return by_name(c.rejected); },
          "Why a view was rejected, by name.")
      .def_readonly("warnings", &LensCalibration::warnings,
                    "What makes the result doubtful, e.g. too few tilts.")
      .def("__repr__", [](const LensCalibration& c) {
        return fmt::format(
            "<kinloop.Calibration: fx {:.2f}, fy {:.2f}, cx {:.2f}, cy {:.2f}, rms {:.3f} px, {} views>",
            c.camera.fx, c.camera.fy, c.camera.cx, c.camera.cy, c.rms_px, c.views.size());
      });
}

}  // namespace

void bind_calibration(py::module_& module) {
  bind_calibration_result(module);
  py::class_<BoardView>(module, "BoardView", R"(A calibration board in an image.

BoardView(board_m, pixels, size, name=""): points on the board (N, 2), metres, the same points in the image (N, 2), px, and
(width, height) of the image.)")
      .def(py::init(&make_view), py::arg("board_m"), py::arg("pixels"), py::arg("size"), py::arg("name") = "")
      .def_property_readonly(
          "board_m", [](const BoardView& v) { return to_rows(v.board_m); }, "Float64 (N, 2), metres.")
      .def_property_readonly(
          "pixels", [](const BoardView& v) { return to_rows(v.pixels); }, "Float64 (N, 2), px.")
      .def_property_readonly(
          "size", [](const BoardView& v) { return std::pair(v.width, v.height); }, "(width, height), px.")
      .def_readonly("name", &BoardView::name);
  module.def("find_board", &find_in_image, py::arg("image"), py::arg("board"), py::arg("square_m"),
             py::arg("marker_m") = 0.0, py::arg("name") = "", R"(Finds a calibration board in an image.

image: uint8 (H, W, 3), red first, or (H, W). board: "7x5" (inner corners) or "charuco:7x5:DICT_4X4_50" (squares).
square_m, marker_m: sides of a square and of a marker, metres. Returns a BoardView, or None if it is not visible.)");
  module.def("calibrate", &calibrate_views, py::arg("views"),
             R"(Calibrates a camera from views of a board (Zhang's method).

calibrate(views): a list of BoardView.
calibrate(folder, board, square_m, marker_m=0, progress=None): finds the board in the images of a folder first.
Keywords are those of kinloop calibrate --set: lens_model, distortion_terms, outlier_factor, ...
Returns a Calibration. Raises InputError for fewer than three views, or if they do not determine a camera.)");
  module.def("calibrate", &calibrate_folder, py::arg("folder"), py::arg("board"), py::arg("square_m"),
             py::arg("marker_m") = 0.0, py::arg("progress") = py::none());
}

}  // namespace kinloop::python
