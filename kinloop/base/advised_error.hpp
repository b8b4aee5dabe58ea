#pragma once

#include <string>
#include <utility>

#include "kinloop/base/errors.hpp"

namespace kinloop {

/// An InputError whose remedy takes more than its one line, such as a file to copy.
class AdvisedError : public InputError {
 public:
  AdvisedError(const std::string& message, std::string advice)
      : InputError(message), advice_(std::move(advice)) {}

  /// The further lines, each ended.
  [[nodiscard]] const std::string& advice() const { return advice_; }

 private:
  std::string advice_;
};

}  // namespace kinloop
