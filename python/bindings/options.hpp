#pragma once
// Options as Python passes them: dictionaries and keywords, with the names of `--set`.

#include <string>
#include <vector>

#include "kinloop/core/progress.hpp"
#include "python/bindings/bindings.hpp"

namespace kinloop::python {

/// Returns "key=value" for every entry; a nested dictionary adds its key and a dot: {"features": {"count":
/// 500}} is the same as {"features.count": 500}. `prefix` is prepended to all keys.
std::vector<std::string> assignments_of(const py::dict& options, const std::string& prefix = {});

/// Same for an optional dictionary and keywords, which override it.
std::vector<std::string> assignments_of(const py::object& options, const py::kwargs& keywords,
                                        const std::string& prefix = {});

/// Returns a progress that calls `callback(stage, done, total)`, if it is not None, and stops on Ctrl-C. The
/// GIL must be released while the work runs. After the work, `rethrow` raises what the callback or Ctrl-C
/// raised.
class PythonProgress {
 public:
  explicit PythonProgress(py::object callback) : callback_(std::move(callback)) {}

  [[nodiscard]] Progress function();
  void rethrow();

 private:
  bool report(const ProgressReport& report);

  py::object callback_;
  std::exception_ptr error_;
};

/// Same, of a callback that may be None.
inline PythonProgress progress_of(py::object callback) {
  return PythonProgress(std::move(callback));
}

}  // namespace kinloop::python
