#pragma once
// In: an exception. Out: what the program prints and returns for it.

#include <exception>
#include <string>
#include <string_view>

#include "apps/shared/command_line/commands.hpp"

namespace kinloop {

/// How a command failed.
struct Failure {
  ExitCode exit_code = ExitCode::kInternalError;
  std::string message;                 ///< one line, with the remedy
  std::string hint;                    ///< further lines
  std::string_view code = "internal";  ///< internal, usage, input, output, limit or memory
};

/// Everyday faults of the machine (memory, threads, permissions, names) have a message of their own; what is
/// left is an error of the program.
Failure describe_failure(const std::exception& error);

/// Appends {"code": "..."} to the file that the environment variable KINLOOP_ERRORS names, for a program that
/// has started this one: messages are for people. Needs no memory.
void tell_error_code(std::string_view code);

}  // namespace kinloop
