#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/text/json.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/gil.hpp"
#include "python/bindings/stamps.hpp"
#include "python/bindings/trajectory.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop::python {
namespace {

std::string name_of_argument(const py::object& argument, const char* otherwise) {
  return py::isinstance<PyTrajectory>(argument) ? otherwise : std::string(py::str(argument));
}

Evaluation evaluate_arguments(const py::object& estimate, const py::object& truth) {
  const Trajectory a = trajectory_argument(estimate, "estimate"), b = trajectory_argument(truth, "truth");
  const auto evaluation = without_gil([&] { return evaluate(a, b); });
  if (evaluation) return *evaluation;
  throw InputError(fmt::format("{}: {}; give the ground truth of the same recording",
                               name_of_argument(truth, "truth"), evaluation_failure(a, b)));
}

template <class T>
py::array_t<double> per_error(const Evaluation& evaluation, const T& value) {
  py::array_t<double> array(static_cast<py::ssize_t>(evaluation.ate.poses.size()));
  double* at = array.mutable_data();
  for (const PoseError& pose : evaluation.ate.poses) *at++ = value(pose);
  return array;
}

py::object evaluation_dict(const Evaluation& evaluation) {
  return py::module_::import("json").attr("loads")(json_text(to_json(evaluation)));
}

std::string evaluation_text(const Evaluation& e) {
  std::string text = fmt::format("<kinloop.Evaluation: ATE {:.4f} m", e.ate.error_m.rmse);
  if (e.rpe_second)
    text += fmt::format(", RPE {:.4f} m and {:.3f} deg per second", e.rpe_second->translation_m.rmse,
                        e.rpe_second->rotation_deg.rmse);
  return text + fmt::format(", {} poses>", e.ate.error_m.count);
}

}  // namespace

void bind_evaluation(py::module_& module) {
  py::class_<ErrorStatistics>(module, "ErrorStatistics", "Statistics of errors, in their unit.")
      .def_readonly("rmse", &ErrorStatistics::rmse, "Root of the mean square.")
      .def_readonly("mean", &ErrorStatistics::mean)
      .def_readonly("median", &ErrorStatistics::median)
      .def_readonly("std", &ErrorStatistics::std, "Standard deviation, as numpy.std.")
      .def_readonly("min", &ErrorStatistics::min)
      .def_readonly("max", &ErrorStatistics::max)
      .def_readonly("count", &ErrorStatistics::count, "Number of errors.")
      .def("__repr__", [](const ErrorStatistics& s) {
        return fmt::format("<kinloop.ErrorStatistics: rmse {:.6f}, median {:.6f}, max {:.6f}, {} errors>",
                           s.rmse, s.median, s.max, s.count);
      });
  py::class_<RpeResult>(module, "RelativePoseError",
                        "Errors of the motion over an interval, a measure of drift.")
      .def_readonly("translation_m", &RpeResult::translation_m, "ErrorStatistics, metres.")
      .def_readonly("rotation_deg", &RpeResult::rotation_deg, "ErrorStatistics, degrees.");
  py::class_<Evaluation>(module, "Evaluation",
                         "How far an estimate is from the truth; the figures of kinloop eval.")
      .def_property_readonly(
          "ate_m", [](const Evaluation& e) { return e.ate.error_m; },
          "Absolute trajectory error after the best rigid alignment: ErrorStatistics, metres.")
      .def_readonly("rpe_second", &Evaluation::rpe_second,
                    "RelativePoseError over 1 s; None without such pairs.")
      .def_readonly("rpe_frame", &Evaluation::rpe_frame,
                    "RelativePoseError from each frame to the next, or None.")
      .def_property_readonly(
          "coverage", [](const Evaluation& e) { return e.coverage.time_fraction; },
          "Fraction of the truth's time span that the estimate covers.")
      .def_property_readonly(
          "matched", [](const Evaluation& e) { return e.coverage.matched_fraction; },
          "Fraction of the estimated poses that have a true one.")
      .def_property_readonly(
          "T_truth_estimate", [](const Evaluation& e) { return e.ate.T_truth_estimate.matrix(); },
          "The alignment, from the estimate's world to that of the truth, float64 (4, 4).")
      .def_property_readonly(
          "stamps_s",
          [](const Evaluation& e) {
            return per_error(e, [](const PoseError& p) { return seconds_of(p.stamp_ns); });
          },
          "Stamps of the compared poses, float64 (N,).")
      .def_property_readonly(
          "errors_m",
          [](const Evaluation& e) { return per_error(e, [](const PoseError& p) { return p.error_m; }); },
          "Distance of each compared pose from the true one, float64 (N,), metres.")
      .def("to_dict", &evaluation_dict, "Returns the figures with the names of kinloop eval --json.")
      .def("__repr__", &evaluation_text);
  module.def("evaluate", &evaluate_arguments, py::arg("estimate"), py::arg("truth"),
             R"(Compares a trajectory with the truth, as the tools of the TUM RGB-D benchmark do.

Both are a Trajectory or the path of a file in TUM format. Poses at most 0.02 s apart are associated; the estimate is
aligned without scale. Raises InputError if fewer than three poses have a true one.)");
}

}  // namespace kinloop::python
