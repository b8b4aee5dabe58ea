#pragma once
// Runs the program as a black box.

#include <cstdlib>
#include <filesystem>
#include <map>
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

/// Writes a simulated room to `folder`, of 160x120 unless `arguments` of `simulate` give a --size. A room is
/// rendered once for all tests of a process.
inline void write_room(const std::filesystem::path& folder, const std::string& arguments) {
  static const TempFolder rendered;
  static std::map<std::string, std::filesystem::path> rooms;
  const auto [room, is_new] = rooms.try_emplace(arguments, rendered.path() / std::to_string(rooms.size()));
  if (is_new) {
    const std::string size = arguments.find("--size") == std::string::npos ? "--size 160x120 " : "";
    const auto done =
        run_program(rendered, "simulate room -q -o '" + room->second.string() + "' " + size + arguments);
    ASSERT_EQ(done.exit_code, kDone) << done.err;
  }
  std::filesystem::create_directories(folder.parent_path());
  std::filesystem::copy(room->second, folder, std::filesystem::copy_options::recursive);
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
