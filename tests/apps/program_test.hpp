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

class ProgramTest : public testing::Test {
 protected:
  struct Run {
    int exit_code;
    std::string out, err;
  };

  /// A path in the folder of the test.
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_.path() / name).string(); }

  [[nodiscard]] Run shell(const std::string& command) const {
    const int status =
        std::system(("{ " + command + "; } >'" + at("stdout") + "' 2>'" + at("stderr") + "'").c_str());
    return {WEXITSTATUS(status), read_file(at("stdout")), read_file(at("stderr"))};
  }

  /// `arguments` after "kinloop", with `before` (e.g. variables) before it.
  [[nodiscard]] Run run(const std::string& arguments, const std::string& before = "") const {
    return shell(before + " '" KINLOOP_PROGRAM "' " + arguments);
  }

  const TempFolder folder_;
};

}  // namespace kinloop::test
