#include <spdlog/sinks/stdout_color_sinks.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/options.hpp"
#include "python/bindings/bindings.hpp"

namespace kinloop::python {
namespace {

/// As in the program: messages go to standard error, without the time.
void set_up_log() {
  auto logger =
      std::make_shared<spdlog::logger>("kinloop", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  logger->set_pattern("%^%l:%$ %v");
  logger->set_level(spdlog::level::warn);
  spdlog::set_default_logger(logger);
}

void set_log_level(const std::string& level) {
  const auto value = spdlog::level::from_str(level);
  if (value == spdlog::level::off && level != "off")
    throw UsageError("set_log_level: '" + level + "' is not one of debug, info, warning, error, off");
  log::set_level(value);
}

/// Both are subclasses of ValueError, with the texts of the program.
void bind_exceptions(py::module_& module) {
  static PyObject* input_error = nullptr;
  static PyObject* usage_error = nullptr;
  input_error = py::exception<InputError>(module, "InputError", PyExc_ValueError).release().ptr();
  usage_error = py::exception<UsageError>(module, "UsageError", PyExc_ValueError).release().ptr();
  py::handle(input_error).attr("__doc__") =
      "A file, folder or device that cannot be used. The text names it and the remedy.";
  py::handle(usage_error).attr("__doc__") =
      "An invalid argument or option. The text names it and what was expected.";
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      if (error) std::rethrow_exception(error);
    } catch (const InputErrorWithHint& e) {
      PyErr_SetString(input_error, (std::string(e.what()) + "\n" + e.hint()).c_str());
    } catch (const InputError& e) {
      PyErr_SetString(input_error, e.what());
    } catch (const UsageError& e) {
      PyErr_SetString(usage_error, e.what());
    }
  });
}

}  // namespace
}  // namespace kinloop::python

PYBIND11_MODULE(_kinloop, module) {
  using namespace kinloop::python;
  namespace py = pybind11;
  module.attr("__version__") = KINLOOP_VERSION;
  set_up_log();
  py::options options;
  options.disable_function_signatures();  // the stubs have them, with better types
  bind_exceptions(module);
  bind_camera(module);
  bind_trajectory(module);
  bind_source(module);
  bind_dense(module);
  bind_pose_graph(module);
  bind_slam(module);
  bind_result(module);
  bind_map_file(module);
  bind_evaluation(module);
  bind_places(module);
  bind_calibration(module);
  bind_viewer(module);
  module.def("set_log_level", &set_log_level, py::arg("level"),
             "Sets what is logged to standard error: \"debug\", \"info\", \"warning\" (default), \"error\" "
             "or \"off\".");
}
