#pragma once
// Command lines with common mistakes, and the required error message for each. All run in a folder filled by
// make_mistake_folder.

#include <string>
#include <vector>

#include "tests/apps/program_test.hpp"

namespace kinloop::test {

/// A command line and the expected error.
struct MisuseCase {
  std::string arguments;
  int exit_code = 0;
  std::vector<std::string> said;  ///< what is wrong, where, and the remedy
  std::string before = {};        ///< a shell command to run first, e.g. a limit
};

/// Fills `folder` with a small sequence and its run, and with typical wrong inputs.
void make_mistake_folder(const TempFolder& folder);

/// Invalid commands, options and values.
std::vector<MisuseCase> command_line_mistakes();

/// Inputs that are not a sequence, or a damaged one.
std::vector<MisuseCase> sequence_mistakes();

/// Other inputs, and outputs that cannot be written.
std::vector<MisuseCase> file_mistakes();

}  // namespace kinloop::test
