#pragma once

#include <string>
#include <utility>

#include "kinloop/base/errors.hpp"

namespace kinloop {

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
