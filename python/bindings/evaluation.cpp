#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/time.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/gil.hpp"
#include "python/bindings/stamps.hpp"
#include "python/bindings/trajectory.hpp"
#include "tools/evaluation/compare.hpp"
#include "tools/evaluation/report/evaluation_plot.hpp"
#include "tools/evaluation/report/evaluation_table.hpp"

namespace kinloop::python {
namespace {

/// An evaluation with the trajectories it is of, for plots.
struct PyEvaluation {
  Comparison comparison;

  [[nodiscard]] const Evaluation& figures() const { return comparison.evaluation; }
};

std::string name_of_argument(const py::object& argument, const char* otherwise) {
  return py::isinstance<PyTrajectory>(argument) ? otherwise : std::string(py::str(argument));
}

/// Throws UsageError unless `name` is one of the enum's.
template <class Enum>
Enum choice_of(const std::string& name, const char* argument) {
  if (const auto value = value_named<Enum>(name)) return *value;
  throw UsageError(
      fmt::format("{}: '{}' is not one of {}", argument, name, fmt::join(names_of<Enum>(), ", ")));
}

std::vector<RpeDelta> deltas_of(const std::vector<std::string>& texts) {
  std::vector<RpeDelta> deltas;
  for (const std::string& text : texts) {
    const auto delta = parse_rpe_delta(text);
    if (!delta) throw UsageError("rpe: " + rpe_delta_error(text));
    deltas.push_back(*delta);
  }
  return deltas;
}

struct PyEvaluateOptions {
  std::string align;
  py::object offset;
  double max_difference_s = 0;
  std::vector<std::string> rpe;
  std::string convention;
};

PyEvaluation evaluate_arguments(const py::object& estimate, const py::object& truth,
                                const PyEvaluateOptions& given) {
  ComparisonRequest request{
      {name_of_argument(estimate, "estimate"),
       trajectory_argument(estimate, "estimate", TrajectoryRole::kEstimate)},
      {name_of_argument(truth, "truth"), trajectory_argument(truth, "truth", TrajectoryRole::kTruth)}};
  request.options.alignment = choice_of<Alignment>(given.align, "align");
  request.options.convention = choice_of<Convention>(given.convention, "convention");
  request.options.rpe = deltas_of(given.rpe);
  if (!(given.max_difference_s >= 0) || given.max_difference_s > 10)
    throw UsageError("max_difference: expected seconds from 0 to 10");
  request.options.max_difference_ns = to_ns(given.max_difference_s);
  request.estimate_offset = py::isinstance<py::str>(given.offset);
  if (!request.estimate_offset) {
    request.options.offset_ns = stamp_ns_of(given.offset.cast<double>());
  } else if (given.offset.cast<std::string>() != "estimate") {
    throw UsageError("offset: expected seconds or 'estimate'");
  }
  return {without_gil([&] { return compare(std::move(request)); })};
}

std::string table_of(const std::map<std::string, PyEvaluation>& evaluations, const std::string& format) {
  std::vector<NamedEvaluation> all;
  for (const auto& [name, evaluation] : evaluations) all.push_back({name, evaluation.figures()});
  for (const NamedEvaluation& named : all) {
    if (named.evaluation.rpe.size() != all.front().evaluation.rpe.size())
      throw UsageError("evaluation_table: the evaluations have different intervals of the RPE");
  }
  return evaluation_table(all, choice_of<TableFormat>(format, "format"));
}

std::string plot_of(const std::map<std::string, PyEvaluation>& evaluations) {
  std::vector<PlottedEstimate> plotted;
  Trajectory truth;
  for (const auto& [name, evaluation] : evaluations) {
    plotted.push_back({name, evaluation.comparison.estimate, evaluation.figures()});
    truth = evaluation.comparison.truth;
  }
  return evaluation_plot(plotted, truth);
}

py::dict rpe_dict(const PyEvaluation& evaluation) {
  py::dict errors;
  for (const RpeOver& asked : evaluation.figures().rpe) errors[py::str(to_string(asked.delta))] = asked.error;
  return errors;
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
  py::class_<PyEvaluation>(module, "Evaluation",
                           "How far an estimate is from the truth; the figures of kinloop eval.")
      .def_property_readonly(
          "ate_m", [](const PyEvaluation& e) { return e.figures().ate.error_m; },
          "Absolute trajectory error after the best alignment: ErrorStatistics, metres.")
      .def_property_readonly(
          "rpe_second", [](const PyEvaluation& e) { return e.figures().rpe_second; },
          "RelativePoseError over 1 s; None without such pairs.")
      .def_property_readonly(
          "rpe_frame", [](const PyEvaluation& e) { return e.figures().rpe_frame; },
          "RelativePoseError from each frame to the next, or None.")
      .def_property_readonly("rpe", &rpe_dict,
                             "RelativePoseError or None over the intervals asked for, by names like '1 m'.")
      .def_property_readonly(
          "coverage", [](const PyEvaluation& e) { return e.figures().coverage.time_fraction; },
          "Fraction of the truth's time span that the estimate covers.")
      .def_property_readonly(
          "matched", [](const PyEvaluation& e) { return e.figures().coverage.matched_fraction; },
          "Fraction of the estimated poses that have a true one.")
      .def_property_readonly(
          "T_truth_estimate", [](const PyEvaluation& e) { return e.figures().ate.T_truth_estimate.matrix(); },
          "The alignment, from the estimate's world to that of the truth, after scale, float64 (4, 4).")
      .def_property_readonly(
          "scale", [](const PyEvaluation& e) { return e.figures().ate.scale; },
          "Scale of the alignment; 1 unless align='sim3'.")
      .def_property_readonly(
          "offset_s", [](const PyEvaluation& e) { return to_seconds(e.figures().offset_ns); },
          "Seconds that were added to the stamps of the estimate.")
      .def_property_readonly(
          "notes", [](const PyEvaluation& e) { return e.comparison.notes; },
          "What was recognised or is odd: a list of lines.")
      .def_property_readonly(
          "stamps_s",
          [](const PyEvaluation& e) {
            return per_error(e.figures(), [](const PoseError& p) { return seconds_of(p.stamp_ns); });
          },
          "Stamps of the compared poses, float64 (N,).")
      .def_property_readonly(
          "errors_m",
          [](const PyEvaluation& e) {
            return per_error(e.figures(), [](const PoseError& p) { return p.error_m; });
          },
          "Distance of each compared pose from the true one, float64 (N,), metres.")
      .def(
          "to_dict", [](const PyEvaluation& e) { return evaluation_dict(e.figures()); },
          "Returns the figures with the names of kinloop eval --json.")
      .def("__repr__", [](const PyEvaluation& e) { return evaluation_text(e.figures()); });
  module.def(
      "evaluate",
      [](const py::object& estimate, const py::object& truth, const std::string& align,
         const py::object& offset, double max_difference, const std::vector<std::string>& rpe,
         const std::string& convention) {
        return evaluate_arguments(estimate, truth, {align, offset, max_difference, rpe, convention});
      },
      py::arg("estimate"), py::arg("truth"), py::kw_only(), py::arg("align") = "se3", py::arg("offset") = 0.0,
      py::arg("max_difference") = 0.02, py::arg("rpe") = std::vector<std::string>(),
      py::arg("convention") = "tum",
      R"(Compares a trajectory with the truth, by default as the tools of the TUM RGB-D benchmark do.

Both are a Trajectory or the path of a file (TUM, EuRoC, KITTI, table) or a folder (of a run, of a recording).
align           se3, sim3 (and a scale), yaw (about the truth's z axis) or none
offset          seconds added to the stamps of the estimate; "estimate": found by comparing motion
max_difference  between the stamps of associated poses, s
rpe             further intervals: "5s", "10f" (frames), "0.5m"
convention      tum, or evo: the figures of evo_ape and evo_rpe --all_pairs
Raises InputError where no figure would be right, such as fewer than three poses with a true one.)");
  module.def("evaluation_table", &table_of, py::arg("evaluations"), py::arg("format") = "text",
             R"(Returns evaluations as a table: text, csv, json or latex.

`evaluations` maps names to what evaluate returned.)");
  module.def("evaluation_plot", &plot_of, py::arg("evaluations"),
             R"(Returns an SVG image of the aligned paths and their errors over time.

`evaluations` maps names to what evaluate returned.)");
}

}  // namespace kinloop::python
