#pragma once

#include <memory>
#include <mutex>

#include "python/bindings/bindings.hpp"
#include "session/store/map_store.hpp"

namespace kinloop::python {

/// A map file opened for reading. Constructed without the GIL, so it must not touch a Python object then.
struct PyMap {
  PyMap(const std::filesystem::path& file, const std::vector<std::string>& assignments)
      : path(map_file_of(file)), open(open_map(path, assignments)) {}

  std::filesystem::path path;
  std::mutex mutex;  ///< locked without the GIL
  OpenMap open;
  py::object cloud;  ///< null until it has been asked for
};

}  // namespace kinloop::python
