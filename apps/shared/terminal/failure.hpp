#pragma once
// In: an exception. Out: what the program prints and returns for it.

#include <exception>
#include <string>

#include "apps/shared/command_line/commands.hpp"

namespace kinloop {

/// How a command failed.
struct Failure {
  ExitCode exit_code = ExitCode::kInternalError;
  std::string message;  ///< one line, with the remedy
  std::string hint;     ///< further lines
};

/// Everyday faults of the machine (memory, threads, permissions, names) have a message of their own; what is
/// left is an error of the program.
Failure describe_failure(const std::exception& error);

}  // namespace kinloop
