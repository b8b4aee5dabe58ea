#pragma once
// The three kinds of failure. A violated contract between functions throws std::logic_error (`require`); a
// bad file or option throws one of the exceptions below, which `main` prints; an estimate that is expected to
// fail at times returns an optional value.

#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace kinloop {

/// A file, folder or device that cannot be used (exit code 3). The message names it and the remedy.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A result, or a temporary file, that could not be written: the input may be good. The message names the
/// file and the remedy.
class OutputError : public InputError {
 public:
  using InputError::InputError;
};

/// An invalid command line or option (exit code 2). The message names it and what was expected.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws std::logic_error unless `condition` holds, in release builds too.
inline void require(bool condition, const char* what) {
  if (!condition) throw std::logic_error(what);
}

/// Returns what a C library allocated; throws std::bad_alloc if it is null.
template <typename T>
T* require_memory(T* allocated) {
  if (allocated == nullptr) throw std::bad_alloc();
  return allocated;
}

/// An InputError whose remedy needs more than one line, such as a file to copy.
class InputErrorWithHint : public InputError {
 public:
  InputErrorWithHint(const std::string& message, std::string hint)
      : InputError(message), hint_(std::move(hint)) {}

  /// Further lines of the remedy, each ending in a newline.
  [[nodiscard]] const std::string& hint() const { return hint_; }

 private:
  std::string hint_;
};

}  // namespace kinloop
