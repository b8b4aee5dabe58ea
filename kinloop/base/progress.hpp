#pragma once
// Long work reports how far it is and can be asked to stop; what is shown, and where, is the caller's
// business.

#include <cstddef>
#include <functional>
#include <string>

namespace kinloop {

struct ProgressReport {
  std::string stage;  ///< what is being done, e.g. "mapping"
  size_t done = 0;
  size_t total = 0;  ///< 0 when it is not known
  std::string note;  ///< how it goes, e.g. "tracking, 44 keyframes"
};

/// Called now and then from the working thread; returns false to ask the work to stop with what there is.
using Progress = std::function<bool(const ProgressReport&)>;

/// Tells an optional `progress` where the work is; true when it shall go on.
inline bool report(const Progress& progress, const std::string& stage, size_t done, size_t total) {
  return !progress || progress({stage, done, total, {}});
}

}  // namespace kinloop
