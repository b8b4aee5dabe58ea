// Everyday faults of the machine each have a message of their own, and none of them is an "internal error".

#include "apps/shared/terminal/failure.hpp"

#include <filesystem>
#include <new>
#include <system_error>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <unistd.h>

#include "kinloop/core/errors.hpp"
#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using test::kBadInput;
using test::kDone;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(DescribeFailure, EachFaultHasItsMessage) {
  const auto message = [](const std::exception& error) {
    const Failure failure = describe_failure(error);
    EXPECT_EQ(failure.exit_code, ExitCode::kBadInput);
    EXPECT_THAT(failure.message, Not(HasSubstr("report it")));
    return failure.message;
  };
  const auto path_error = [](std::errc code) {
    return std::filesystem::filesystem_error("status", "some/file", std::make_error_code(code));
  };
  EXPECT_THAT(message(std::bad_alloc()), HasSubstr("out of memory; try"));
  EXPECT_THAT(message(cv::Exception(cv::Error::StsNoMem, "Failed to allocate", "f", "a.cpp", 1)),
              HasSubstr("out of memory; try"));
  EXPECT_THAT(message(path_error(std::errc::permission_denied)),
              AllOf(HasSubstr("some/file"), HasSubstr("permissions of the folders")));
  EXPECT_THAT(message(path_error(std::errc::filename_too_long)),
              AllOf(HasSubstr("some/file"), HasSubstr("use shorter names")));
  EXPECT_THAT(message(std::system_error(EAGAIN, std::generic_category())),
              AllOf(HasSubstr("thread"), HasSubstr("--threads 1")));
  EXPECT_THAT(message(std::system_error(EMFILE, std::generic_category())), HasSubstr("ulimit -n"));
}

TEST(DescribeFailure, ABrokenPromiseIsAnErrorOfTheProgram) {
  for (const auto& error : {std::logic_error("never"), std::logic_error(cv::Exception().what())}) {
    const Failure failure = describe_failure(error);
    EXPECT_EQ(failure.exit_code, ExitCode::kInternalError);
    EXPECT_THAT(failure.message, HasSubstr("please report it"));
  }
  EXPECT_EQ(describe_failure(cv::Exception(cv::Error::StsAssert, "x", "f", "a.cpp", 1)).exit_code,
            ExitCode::kInternalError);
  EXPECT_EQ(describe_failure(UsageError("x")).exit_code, ExitCode::kWrongUse);
}

TEST(DescribeFailure, ProgramsReadItsCode) {
  const auto code = [](const std::exception& error) { return describe_failure(error).code; };
  EXPECT_EQ(code(UsageError("x")), "usage");
  EXPECT_EQ(code(InputError("No space left on device")), "input");
  EXPECT_EQ(code(InputErrorWithHint("x", "y")), "input");
  EXPECT_EQ(code(OutputError("x")), "output");
  EXPECT_EQ(code(std::system_error(ENOSPC, std::generic_category())), "output");
  for (const int limit : {EAGAIN, EMFILE, ENFILE})
    EXPECT_EQ(code(std::system_error(limit, std::generic_category())), "limit");
  EXPECT_EQ(code(std::bad_alloc()), "memory");
  EXPECT_EQ(code(std::logic_error("x")), "internal");
}

class Faults : public test::ProgramTest {
 protected:
  /// Runs the program as a user without rights, limited by `limits` of prlimit.
  [[nodiscard]] Run run_as_nobody(const std::string& arguments, const std::string& limits = "") const {
    std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
    return run(arguments,
               "cd / && prlimit " + limits + " setpriv --reuid=65534 --regid=65534 --clear-groups");
  }

  /// Why the program cannot be run that way; empty if it can.
  [[nodiscard]] std::string obstacle() const {
    if (geteuid() != 0) return "only root may change its user";
    return run_as_nobody("--version").exit_code == 0
               ? ""
               : "setpriv, prlimit or the program cannot be run as nobody";
  }
};

TEST_F(Faults, AFolderThatMayNotBeEntered) {
  if (const auto why = obstacle(); !why.empty()) GTEST_SKIP() << why;
  folder_.write("closed/a.txt", "1 0 0 0 0 0 0 1\n");
  std::filesystem::permissions(at("closed"), std::filesystem::perms(0700));
  std::filesystem::create_directory(at("open"));
  std::filesystem::permissions(at("open"), std::filesystem::perms(0777));
  const std::string file = "'" + at("closed/a.txt") + "' ", folder = "'" + at("closed/sub") + "' ";
  for (const auto& arguments : {"eval " + file + file, "map info " + file, "report " + folder,
                                "run " + folder + "-o '" + at("closed/out") + "'", "probe " + folder,
                                "view " + folder, "optimize " + file + "-o '" + at("open/x.g2o") + "'",
                                "mesh " + file + "-o '" + at("open/x.ply") + "'"}) {
    const Run refused = run_as_nobody(arguments);
    EXPECT_EQ(refused.exit_code, kBadInput) << arguments << refused.err;
    EXPECT_THAT(refused.err, AllOf(HasSubstr("closed"), Not(HasSubstr("report it")))) << arguments;
  }
  EXPECT_THAT(run_as_nobody("eval " + file + file).err, HasSubstr("Permission denied"));
}

TEST_F(Faults, TheCodeIsAppendedToTheFileOfTheCaller) {
  const std::string errors = "KINLOOP_ERRORS='" + at("errors") + "'";
  EXPECT_EQ(run("vocab export default -o '" + at("x.txt") + "'", "ulimit -f 8; " + errors).exit_code,
            kBadInput);
  EXPECT_EQ(run("probe '" + at("No space left on device") + "'", errors).exit_code, kBadInput);
  EXPECT_EQ(read_file(at("errors")), "{\"code\": \"output\"}\n{\"code\": \"input\"}\n");
  EXPECT_EQ(run("probe '" + at("nowhere") + "'", "KINLOOP_ERRORS=/no/such/folder/x").exit_code, kBadInput);
}

TEST_F(Faults, ANameThatIsTooLong) {
  const std::string name = "'" + at(std::string(300, 'n')) + "' ";
  for (const auto& arguments :
       {"eval " + name + name, "map info " + name, "report " + name, "run " + name + "-o '" + at("out") + "'",
        "run sim:room --set sim.frames=2 -o " + name, "probe " + name, "view " + name,
        "optimize " + name + "-o '" + at("open/x.g2o") + "'",
        "mesh " + name + "-o '" + at("open/x.ply") + "'", "vocab info " + name,
        "simulate room --frames 1 -o " + name}) {
    const Run refused = run(arguments);
    EXPECT_EQ(refused.exit_code, kBadInput) << arguments << refused.err;
    EXPECT_THAT(refused.err, Not(HasSubstr("report it"))) << arguments;
    EXPECT_THAT(refused.err, HasSubstr("nnn")) << arguments;
  }
  EXPECT_THAT(run("eval " + name + name).err,
              AllOf(HasSubstr("File name too long"), HasSubstr("use shorter names")));
}

TEST_F(Faults, OutOfMemory) {
  // From too little to start a run to nearly enough: wherever memory ends, the message is the same.
  if (run("--version", "prlimit --as=480000000").exit_code != kDone)
    GTEST_SKIP() << "the program needs more memory to start, as under the address sanitizer";
  int failures = 0;
  for (int megabytes = 320; megabytes <= 480; megabytes += 20) {
    const std::string limit = "prlimit --as=" + std::to_string(megabytes) + "000000";
    if (run("--version", limit).exit_code != kDone) continue;  // the libraries end the program before main
    const Run done = run("run sim:room -q --threads 1 --set sim.frames=8 -o '" + at("out") + "'", limit);
    if (done.exit_code == kDone) continue;
    ++failures;
    EXPECT_EQ(done.exit_code, kBadInput) << megabytes << done.err;
    EXPECT_THAT(done.err, testing::AnyOf(HasSubstr("out of memory; try"), HasSubstr("another thread")))
        << megabytes;
  }
  EXPECT_GT(failures, 0);
}

TEST_F(Faults, ThreadsThatTheSystemRefuses) {
  if (const auto why = obstacle(); !why.empty()) GTEST_SKIP() << why;
  std::filesystem::create_directory(at("out"));
  std::filesystem::permissions(at("out"), std::filesystem::perms(0777));
  // Libraries start threads before main; with fewer they end the program.
  constexpr int kMostOfLibraries = 64;
  int threads = 1;
  const auto limit = [&] { return "--nproc=" + std::to_string(threads); };
  while (threads < kMostOfLibraries && run_as_nobody("--version", limit()).exit_code != kDone) ++threads;
  const Run refused =
      run_as_nobody("run sim:room -q --set sim.frames=2 --threads 4 -o '" + at("out") + "'", limit());
  EXPECT_EQ(refused.exit_code, kBadInput) << refused.err;
  EXPECT_THAT(refused.err, AllOf(HasSubstr("another thread"), HasSubstr("--threads 1")));
}

}  // namespace
}  // namespace kinloop
