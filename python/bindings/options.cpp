#include "python/bindings/options.hpp"

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

namespace kinloop::python {
namespace {

std::string text_of(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  return py::str(value);
}

void collect(const py::dict& options, const std::string& prefix, std::vector<std::string>& assignments) {
  for (const auto& [name, value] : options) {
    const std::string key = prefix + std::string(py::str(name));
    if (py::isinstance<py::dict>(value)) {
      collect(value.cast<py::dict>(), key + ".", assignments);
    } else {
      assignments.push_back(fmt::format("{}={}", key, text_of(value)));
    }
  }
}

}  // namespace

std::vector<std::string> assignments_of(const py::dict& options, const std::string& prefix) {
  std::vector<std::string> assignments;
  collect(options, prefix, assignments);
  return assignments;
}

std::vector<std::string> assignments_of(const py::object& options, const py::kwargs& keywords,
                                        const std::string& prefix) {
  std::vector<std::string> assignments;
  if (!options.is_none()) {
    if (!py::isinstance<py::dict>(options)) throw UsageError("options: expected a dict");
    collect(options.cast<py::dict>(), prefix, assignments);
  }
  collect(keywords, prefix, assignments);
  return assignments;
}

Progress PythonProgress::function() {
  return [this](const ProgressReport& what) { return report(what); };
}

void PythonProgress::rethrow() {
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

bool PythonProgress::report(const ProgressReport& what) {
  if (error_) return false;
  const py::gil_scoped_acquire gil;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (callback_.is_none()) return true;
    const py::object answer = callback_(what.stage, what.done, what.total);
    return answer.is_none() || answer.cast<bool>();
  } catch (...) {
    error_ = std::current_exception();
    return false;
  }
}

}  // namespace kinloop::python
