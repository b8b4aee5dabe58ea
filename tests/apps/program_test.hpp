#pragma once
// Runs the program as a black box.

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "kinloop/core/files/text_file.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop::test {

/// Exit codes.
constexpr int kDone = 0, kWrongUse = 2, kBadInput = 3, kTrackingLost = 4;

/// Exit code and output of the program.
struct ProgramRun {
  int exit_code;
  std::string out, err;
};

/// Runs `command` in a shell, with its output redirected to files in `folder`.
inline ProgramRun run_shell(const TempFolder& folder, const std::string& command) {
  const auto out = folder.path() / "stdout", err = folder.path() / "stderr";
  const int status =
      std::system(("{ " + command + "; } >'" + out.string() + "' 2>'" + err.string() + "'").c_str());
  return {WEXITSTATUS(status), read_file(out), read_file(err)};
}

/// `arguments` follow "kinloop"; `before` (e.g. variables) precedes it.
inline ProgramRun run_program(const TempFolder& folder, const std::string& arguments,
                              const std::string& before = "") {
  return run_shell(folder, before + " '" KINLOOP_PROGRAM "' " + arguments);
}

class ProgramTest : public testing::Test {
 protected:
  using Run = ProgramRun;

  /// A path in the folder of the test.
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_.path() / name).string(); }

  [[nodiscard]] Run shell(const std::string& command) const { return run_shell(folder_, command); }

  [[nodiscard]] Run run(const std::string& arguments, const std::string& before = "") const {
    return run_program(folder_, arguments, before);
  }

  const TempFolder folder_;
};

}  // namespace kinloop::test
