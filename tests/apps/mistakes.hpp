#pragma once
// Command lines with a mistake that people make, and what kinloop must say to each. All run in a folder that
// make_mistake_folder has filled.

#include <string>
#include <vector>

#include "tests/apps/program_test.hpp"

namespace kinloop::test {

/// A command line and the answer to it.
struct Mistake {
  std::string arguments;
  int exit_code = 0;
  std::vector<std::string> said;  ///< what is wrong, where, and the remedy
  std::string before = {};        ///< a shell command before it, e.g. a limit
};

/// Fills `folder` with a small sequence and its run, and with what people have instead.
void make_mistake_folder(const TempFolder& folder);

/// Wrong commands, options and values.
std::vector<Mistake> command_line_mistakes();

/// Inputs that are no sequence, or a broken one.
std::vector<Mistake> sequence_mistakes();

/// Other inputs, and outputs that cannot be written.
std::vector<Mistake> file_mistakes();

}  // namespace kinloop::test
