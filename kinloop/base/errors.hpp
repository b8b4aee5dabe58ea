#pragma once
// The three kinds of failure. A broken promise between functions throws std::logic_error (`require`); a bad
// file or option throws one of the two below, and `main` prints it; an expected failure of an estimate is a
// value.

#include <stdexcept>
#include <string>

namespace kinloop {

/// A file, folder or device that cannot be used as given (exit code 3). The message names it and the remedy.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A command line or option that makes no sense (exit code 2). The message names it and what was expected.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws std::logic_error unless `condition` holds; stays on in release builds.
inline void require(bool condition, const char* what) {
  if (!condition) throw std::logic_error(what);
}

}  // namespace kinloop
