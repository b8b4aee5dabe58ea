#pragma once
// The program, run from outside.

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "kinloop/base/text_file.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop::test {

/// Exit codes.
constexpr int kDone = 0, kWrongUse = 2, kBadInput = 3, kTrackingLost = 4;

/// How the program ended and what it printed.
struct ProgramRun {
  int exit_code;
  std::string out, err;
};

/// Runs `command` in a shell, with files for what it prints in `folder`.
inline ProgramRun run_shell(const TempFolder& folder, const std::string& command) {
  const auto out = folder.path() / "stdout", err = folder.path() / "stderr";
  const int status =
      std::system(("{ " + command + "; } >'" + out.string() + "' 2>'" + err.string() + "'").c_str());
  return {WEXITSTATUS(status), read_file(out), read_file(err)};
}

/// `arguments` after "kinloop", with `before` (e.g. variables) before it.
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
