// Each common mistake on the command line gives an exit code and a message with the problem and the remedy.
// With KINLOOP_MISTAKES_TABLE=FILE the test also writes a table of the messages (bench/mistakes.sh).

#include "tests/apps/mistakes.hpp"

#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "kinloop/core/stopwatch.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using test::MisuseCase;
using testing::HasSubstr;
using testing::Not;

/// Writes rows of a Markdown table, if requested.
class Table {
 public:
  Table() {
    const char* path = std::getenv("KINLOOP_MISTAKES_TABLE");
    if (path == nullptr) return;
    file_.open(path, std::ios::app);
  }

  void add(const MisuseCase& mistake, const test::ProgramRun& run, double seconds) {
    if (!file_.is_open()) return;
    std::string line = run.err.substr(0, run.err.find('\n'));
    if (line.starts_with("error: ")) line.erase(0, std::string("error: ").size());
    file_ << fmt::format("| `{}{}` | {} | {:.2f} | {} |\n",
                         mistake.before.empty() ? "" : mistake.before + " ", mistake.arguments, run.exit_code,
                         seconds, line);
  }

 private:
  std::ofstream file_;
};

class Mistakes : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TempFolder;
    test::make_mistake_folder(*folder_);
  }
  static void TearDownTestSuite() { delete folder_; }

  static void expect_answers(const std::vector<MisuseCase>& mistakes) {
    Table table;
    for (const MisuseCase& mistake : mistakes) {
      SCOPED_TRACE("kinloop " + mistake.arguments);
      const Stopwatch watch;
      const auto run = test::run_program(
          *folder_, mistake.arguments, fmt::format("cd '{}'; {}", folder_->path().string(), mistake.before));
      table.add(mistake, run, watch.wall_s());
      EXPECT_EQ(run.exit_code, mistake.exit_code);
      EXPECT_THAT(run.err, HasSubstr("error: "));
      EXPECT_THAT(run.err, Not(HasSubstr("internal error")));
      for (const std::string& piece : mistake.said) EXPECT_THAT(run.err, HasSubstr(piece));
      const bool guess_expected =
          std::any_of(mistake.said.begin(), mistake.said.end(), [](const auto& piece) {
            return piece.find("did you mean") != std::string::npos ||
                   piece.find("'dense.") != std::string::npos;
          });
      if (!guess_expected) {
        EXPECT_THAT(run.err, Not(HasSubstr("did you mean")));
      }
      expect_no_output();
    }
  }

  /// The output does not exist, or is an empty folder from the check that it is writable.
  static void expect_no_output() {
    for (const char* name : {"x", "x.ply", "x.txt", "x.g2o", "x.kinvoc", "mesh.off"}) {
      const fs::path path = folder_->path() / name;
      EXPECT_TRUE(!fs::exists(path) || (fs::is_directory(path) && fs::is_empty(path))) << name;
    }
  }

  static inline test::TempFolder* folder_ = nullptr;
};

TEST_F(Mistakes, OnTheCommandLine) {
  expect_answers(test::command_line_mistakes());
}

TEST_F(Mistakes, InSequences) {
  expect_answers(test::sequence_mistakes());
}

TEST_F(Mistakes, InFiles) {
  expect_answers(test::file_mistakes());
}

}  // namespace
}  // namespace kinloop
