#pragma once
// Progress and cancellation of long operations. The caller decides what is shown and where.

#include <cstddef>
#include <functional>
#include <string>

namespace kinloop {

struct ProgressReport {
  std::string stage;  ///< current step, e.g. "mapping"
  size_t done = 0;
  size_t total = 0;  ///< 0 if unknown
  std::string note;  ///< details, e.g. "tracking, 44 keyframes"
};

/// Called regularly from the working thread; returns false to stop early with the result so far.
using Progress = std::function<bool(const ProgressReport&)>;

/// Reports to an optional `progress`; returns true if the work should continue.
inline bool report(const Progress& progress, const std::string& stage, size_t done, size_t total) {
  return !progress || progress({stage, done, total, {}});
}

}  // namespace kinloop
