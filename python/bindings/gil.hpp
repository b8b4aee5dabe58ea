#pragma once

#include "python/bindings/bindings.hpp"

namespace kinloop::python {

/// Returns `work()`, done while other Python threads run. Whoever waits for a run's mutex must do so: the
/// run's threads may need the GIL to release an array.
template <class Work>
auto without_gil(const Work& work) {
  const py::gil_scoped_release released;
  return work();
}

}  // namespace kinloop::python
