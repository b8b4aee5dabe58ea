#pragma once

#include <memory>
#include <mutex>

#include "apps/shared/map_store.hpp"
#include "python/bindings/bindings.hpp"

namespace kinloop::python {

/// A map file opened for reading. Made and destroyed with the GIL: it holds a Python object.
struct PyMap {
  PyMap(std::filesystem::path file, OpenMap map) : path(std::move(file)), open(std::move(map)) {}

  std::filesystem::path path;
  std::mutex mutex;  ///< locked without the GIL
  OpenMap open;
  py::object cloud = py::none();  ///< once it has been asked for
};

/// Opens a map file, or that of a run's folder; called with the GIL, which is released while the file is
/// read.
std::shared_ptr<PyMap> open_py_map(const std::filesystem::path& file_or_folder,
                                   const std::vector<std::string>& assignments);

}  // namespace kinloop::python
