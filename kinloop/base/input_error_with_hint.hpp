#pragma once

#include <string>
#include <utility>

#include "kinloop/base/errors.hpp"

namespace kinloop {

/// An InputError whose remedy takes more than its one line, such as a file to copy.
class InputErrorWithHint : public InputError {
 public:
  InputErrorWithHint(const std::string& message, std::string hint)
      : InputError(message), hint_(std::move(hint)) {}

  /// The further lines, each ended.
  [[nodiscard]] const std::string& hint() const { return hint_; }

 private:
  std::string hint_;
};

}  // namespace kinloop
