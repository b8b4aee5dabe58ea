// The exit codes of runs that were interrupted, of output that nobody receives, and of sources that vanish.

#include <filesystem>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tests/apps/program_test.hpp"
#include "tests/support/private_device.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using test::kBadInput;
using test::kDone;
using test::kWrongUse;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kProgram = "'" KINLOOP_PROGRAM "'";

class ExitCodes : public test::ProgramTest {
 protected:
  /// A sequence of a few small frames.
  [[nodiscard]] std::string sequence(int frames) const {
    test::write_room(at("seq"), "--frames " + std::to_string(frames));
    return at("seq");
  }

  /// Sends the signal to a run once it has begun, and waits for its end.
  [[nodiscard]] Run interrupted_run(const std::string& signal, const std::string& before = "") const {
    const std::string wait = "i=0; while ! grep -q mapping '" + at("log") +
                             "' && [ $i -lt 600 ]; do sleep 0.1; i=$((i+1)); done; ";
    return shell(before + std::string(kProgram) + " run '" + sequence(60) + "' --pace 10 -o '" + at("out") +
                 "' 2>'" + at("log") + "' & pid=$!; " + wait + "kill -" + signal + " $pid; wait $pid");
  }
};

TEST_F(ExitCodes, AnInterruptedRunSavesAndTellsTheSignal) {
  const std::pair<const char*, int> signals[] = {{"INT", 130}, {"TERM", 143}, {"HUP", 129}};
  for (const auto& [signal, code] : signals) {
    std::filesystem::remove_all(at("out"));
    for (const char* old : {"seq", "log"}) std::filesystem::remove_all(at(old));
    const Run done = interrupted_run(signal);
    EXPECT_EQ(done.exit_code, code) << signal << read_file(at("log"));
    EXPECT_EQ(run("map info '" + at("out") + "'").exit_code, kDone) << signal;
    const auto summary = nlohmann::json::parse(read_file(at("out/run.json")));
    EXPECT_TRUE(summary.at("interrupted").get<bool>()) << signal;
    EXPECT_TRUE(std::filesystem::exists(at("out/report.html"))) << signal;
  }
}

TEST_F(ExitCodes, AStackThatIsTooSmallIsNamed) {
  const Run small = run("run sim:room -o '" + at("out") + "'", "ulimit -s 128;");
  EXPECT_EQ(small.exit_code, kWrongUse);
  EXPECT_THAT(small.err, AllOf(HasSubstr("the stack is limited to 128 KiB"), HasSubstr("ulimit -s 8192")));
  EXPECT_EQ(run("run '" + sequence(8) + "' -q -o '" + at("out") + "'", "ulimit -s 512;").exit_code, kDone);
}

TEST_F(ExitCodes, TheProgramStartsWhereNoThreadCan) {
  if (shell("ldd " + std::string(kProgram) + " | grep -q libopenvdb").exit_code == 0)
    GTEST_SKIP() << "the templates of this old OpenVDB need its library, which starts threads";
  const std::string as_user =  // root has no such limit
      geteuid() == 0 ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "";
  if (shell(as_user + "test -x " + kProgram).exit_code != 0)
    GTEST_SKIP() << "no other user can run the program in this folder";
  const Run version = run("--version", as_user + "prlimit --nproc=1");
  EXPECT_EQ(version.exit_code, kDone) << version.err;
  EXPECT_THAT(version.out, HasSubstr("meshes: "));
}

TEST_F(ExitCodes, AnInterruptedRunDoesNotWaitForASilentSender) {
  const auto send = test::source_folder() / "docs/examples/python/stream_frames.py";
  folder_.write("interrupt.sh", R"(cd "${0%/*}"
rm -rf fifo out log code
mkfifo fifo
exec 3<>fifo
{ sh -c 'echo $$ >pid; exec "$0" run - -v -o out' "$1" <fifo 2>log >/dev/null; echo $? >code; } 3>&- &
cat bytes >&3
wait_for() { i=0; while ! "$@" && [ $i -lt 300 ]; do sleep 0.1; i=$((i+1)); done; }
wait_for grep -q 'keyframe 0 ' log
sleep 2  # until all frames are taken
kill -INT $(cat pid)
wait_for test -s code
cat code
exec 3>&-
wait)");
  const std::string python = "python3 '" + send.string() + "' '" + sequence(4) + "' ";
  for (const char* live : {"", "--live"}) {
    ASSERT_EQ(shell(python + live + " >'" + at("bytes") + "'").exit_code, kDone);
    const Run done = shell("sh '" + at("interrupt.sh") + "' " + kProgram);
    EXPECT_EQ(done.out, "130\n") << live << read_file(at("log"));
    const auto summary = nlohmann::json::parse(read_file(at("out/run.json")));
    EXPECT_TRUE(summary.at("interrupted").get<bool>()) << live;
    EXPECT_TRUE(std::filesystem::exists(at("out/report.html"))) << live;
  }
}

TEST_F(ExitCodes, NohupIsRespected) {
  EXPECT_EQ(interrupted_run("HUP", "trap '' HUP; ").exit_code, kDone);
}

TEST_F(ExitCodes, ATerminalThatIsClosedDoesNotEndARunWithoutItsResults) {
  const std::string terminal = R"(import os, pty, sys, time
try: pid, terminal = pty.fork()
except OSError: sys.exit(77)
if pid == 0: os.execv(sys.argv[1], sys.argv[1:])
seen = b''
while b'mapping' not in seen: seen += os.read(terminal, 1000)
os.close(terminal)
_, status = os.waitpid(pid, 0)
sys.exit(os.waitstatus_to_exitcode(status) % 256))";
  folder_.write("terminal.py", terminal);
  const Run done = shell("python3 '" + at("terminal.py") + "' " + kProgram + " run '" + sequence(60) +
                         "' --pace 10 -o '" + at("out") + "'");
  constexpr int kNoTerminal = 77;
  if (done.exit_code == kNoTerminal) GTEST_SKIP() << "this system has no pseudo-terminals (/dev/pts)";
  EXPECT_EQ(done.exit_code, 129) << done.err;
  EXPECT_EQ(run("map info '" + at("out") + "'").exit_code, kDone);
  EXPECT_TRUE(std::filesystem::exists(at("out/report.html")));
}

TEST_F(ExitCodes, OutputThatNobodyReceivesIsAnError) {
  folder_.write("a.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 0 1 0 0 0 0 1\n4 0 1 1 0 0 0 1\n");
  const std::string eval = std::string(kProgram) + " eval '" + at("a.txt") + "' '" + at("a.txt") + "'";
  EXPECT_EQ(shell(eval).exit_code, kDone);
  const Run full = shell(eval + " >/dev/full");
  EXPECT_EQ(full.exit_code, kBadInput);
  EXPECT_THAT(full.err, AllOf(HasSubstr("standard output"), HasSubstr("No space left")));
  const Run closed = shell(eval + " >&-");
  EXPECT_EQ(closed.exit_code, kBadInput);
  EXPECT_THAT(closed.err, HasSubstr("standard output"));
  EXPECT_EQ(shell("{ sleep 0.2; " + eval + "; echo $? >'" + at("code") + "'; } | true").err, "");
  EXPECT_EQ(read_file(at("code")), "141\n") << "as a program that SIGPIPE ends";
  EXPECT_EQ(shell(std::string(kProgram) + " run --options=all >/dev/full").exit_code, kBadInput);
  EXPECT_EQ(shell(std::string(kProgram) + " --help >/dev/full").exit_code, kBadInput);
}

TEST_F(ExitCodes, NoFileGetsTheNumberOfAClosedStandardOutput) {
  const Run done = shell(std::string(kProgram) + " run '" + sequence(4) + "' -o '" + at("out") + "' >&-");
  EXPECT_EQ(done.exit_code, kBadInput);
  EXPECT_THAT(done.err, HasSubstr("the results in files are complete"));
  EXPECT_EQ(run("map info '" + at("out") + "'").exit_code, kDone);
}

TEST_F(ExitCodes, AnInputThatVanishesHalfWayIsAnErrorWithResults) {
  const std::string folder = sequence(12);
  for (const bool most : {false, true}) {
    int kept = 0;
    for (const auto& image : std::filesystem::directory_iterator(folder + "/depth"))
      if (++kept > (most ? 4 : 7)) std::filesystem::remove(image.path());
    std::filesystem::remove_all(at("out"));
    const Run done = run("run '" + folder + "' -q -o '" + at("out") + "'");
    if (most) {
      EXPECT_EQ(done.exit_code, kBadInput) << done.err;
      EXPECT_THAT(done.err, HasSubstr("over half of the frames could not be used (8 of 12)"));
    } else {
      EXPECT_NE(done.exit_code, kBadInput) << done.err;
      EXPECT_THAT(done.err, HasSubstr("5 frames were skipped"));
    }
    EXPECT_TRUE(std::filesystem::exists(at("out/trajectory.txt")));
    EXPECT_TRUE(std::filesystem::exists(at("out/map.kinmap")));
  }
}

class Outputs : public ExitCodes {};

TEST_F(Outputs, StandardOutputCarriesNothingButTheContent) {
  const std::string to = test::private_standard_output(folder_).string();
  ASSERT_EQ(run("run '" + sequence(4) + "' -q -o '" + at("out") + "'").exit_code, kDone);
  EXPECT_EQ(run("export '" + at("out") + "' --trajectory '" + at("t.txt") + "'").exit_code, kDone);
  const Run piped = run("export '" + at("out") + "' --trajectory '" + to + "'");
  EXPECT_EQ(piped.exit_code, kDone) << piped.err;
  EXPECT_EQ(piped.out, read_file(at("t.txt")));
  const Run graph = run("optimize '" + at("out/graph.g2o") + "' -o '" + to + "'");
  EXPECT_EQ(graph.exit_code, kDone) << graph.err;
  EXPECT_EQ(run("optimize '" + at("out/graph.g2o") + "' -o '" + at("solved.g2o") + "'").exit_code, kDone);
  EXPECT_EQ(graph.out, read_file(at("solved.g2o")));
  EXPECT_EQ(run("run '" + at("seq") + "' -q --save-map '" + to + "' -o '" + at("out") + "'").exit_code,
            kWrongUse);
}

TEST_F(Outputs, TwoRunsIntoOneFolder) {
  const std::string folder = sequence(60);
  const std::string first =
      std::string(kProgram) + " run '" + folder + "' --pace 20 -q -o '" + at("out") + "' & pid=$!; ";
  const std::string wait = "i=0; while [ ! -d '" + at("out") +
                           "' ] && [ $i -lt 600 ]; do sleep 0.1; i=$((i+1)); done; sleep 0.3; ";
  const Run second = shell(first + wait + kProgram + " run '" + folder + "' -q -o '" + at("out") +
                           "'; echo $?; wait $pid; echo $?");
  EXPECT_EQ(second.out, "3\n0\n") << second.err;
  EXPECT_THAT(second.err, AllOf(HasSubstr(at("out")), HasSubstr("another run is writing into this folder")));
  EXPECT_EQ(run("map info '" + at("out") + "'").exit_code, kDone);
}

TEST_F(Outputs, LeftoversOfAKilledRunAreCleared) {
  const std::string folder = sequence(60);
  folder_.write("out/kinloop-4242-0.tmp", "half a map");
  folder_.write("out/map.kinmap.tmp", "of version 0.1");
  folder_.write("out/loops/kinloop-4242-1.tmp", "half a picture");
  folder_.write("out/notes.tmp", "of the user");
  EXPECT_EQ(run("run '" + folder + "' -q -o '" + at("out") + "'").exit_code, kDone);
  EXPECT_FALSE(std::filesystem::exists(at("out/kinloop-4242-0.tmp")));
  EXPECT_FALSE(std::filesystem::exists(at("out/map.kinmap.tmp")));
  EXPECT_FALSE(std::filesystem::exists(at("out/loops/kinloop-4242-1.tmp")));
  EXPECT_EQ(read_file(at("out/notes.tmp")), "of the user");
}

TEST_F(Outputs, MapFilesAreTheSameForAnyNumberOfThreads) {
  const std::string folder = sequence(30);
  for (const char* threads : {"1", "3"})
    ASSERT_EQ(run("run '" + folder + "' -q --threads " + threads + " -o '" + at(threads) + "'").exit_code,
              kDone);
  EXPECT_TRUE(read_file(at("1/map.kinmap")) == read_file(at("3/map.kinmap")));
}

TEST_F(Outputs, AMemoryLimitDoesNotChangeThem) {
  const std::string folder = sequence(30);
  ASSERT_EQ(run("run '" + folder + "' -q -o '" + at("unlimited") + "'").exit_code, kDone);
  for (const std::string memory : {"1", "1000"}) {
    ASSERT_EQ(run("run '" + folder + "' -q --memory " + memory + " -o '" + at(memory) + "'").exit_code,
              kDone);
    for (const char* name : {"trajectory.txt", "live.txt", "map.ply", "map.kinmap"})
      EXPECT_TRUE(read_file(at(memory + "/" + name)) == read_file(at(std::string("unlimited/") + name)))
          << name;
  }
}

TEST_F(Outputs, FilesAreFlushedOnceEach) {
  if (shell("strace -V").exit_code != 0) GTEST_SKIP() << "strace is not installed";
  const Run done = shell("strace -f -y -e trace=fsync,fdatasync -o '" + at("trace") + "' " + kProgram +
                         " run '" + sequence(4) + "' -q -o '" + at("out") + "'");
  if (done.err.find("ptrace") != std::string::npos) GTEST_SKIP() << "strace is not permitted";
  ASSERT_EQ(done.exit_code, kDone) << done.err;
  const std::string trace = read_file(at("trace"));
  size_t flushed = 0, written = 0;
  for (size_t at = trace.find(".tmp>)"); at != std::string::npos; at = trace.find(".tmp>)", at + 1))
    ++flushed;
  for (const auto& entry : std::filesystem::directory_iterator(at("out")))
    written += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(flushed, written) << trace;
  EXPECT_THAT(trace, HasSubstr("/out>)"));
}

TEST_F(Outputs, TheNewContentOfAPrivateFileIsPrivateFromTheStart) {
  if (shell("strace -V").exit_code != 0) GTEST_SKIP() << "strace is not installed";
  const auto file = folder_.write("words.txt", "old");
  std::filesystem::permissions(file,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  const Run done = shell("umask 0; strace -f -e trace=open,openat -o '" + at("trace") + "' " + kProgram +
                         " vocab export default -o '" + file.string() + "'");
  if (done.err.find("ptrace") != std::string::npos) GTEST_SKIP() << "strace is not permitted";
  ASSERT_EQ(done.exit_code, kDone) << done.err;
  const std::string trace = read_file(at("trace"));
  EXPECT_THAT(trace, HasSubstr("O_RDWR|O_CREAT|O_EXCL|O_CLOEXEC, 0600"));
  EXPECT_EQ(trace.find("O_RDWR|O_CREAT|O_EXCL|O_CLOEXEC, 0666"), std::string::npos) << trace;
}

TEST_F(Outputs, EvalRefusesPositionsBeyondTheWorld) {
  const std::string good = "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 0 1 0 0 0 0 1\n";
  folder_.write("good.txt", good);
  for (const char* number : {"1000001", "-1e154", "inf"}) {
    folder_.write("bad.txt", good + "4 0 0 " + number + " 0 0 0 1\n");
    for (const auto& [a, b] : {std::pair("good.txt", "bad.txt"), std::pair("bad.txt", "good.txt")}) {
      const Run refused = run("eval '" + at(a) + "' '" + at(b) + "'");
      EXPECT_EQ(refused.exit_code, kBadInput) << number;
      EXPECT_THAT(refused.err, HasSubstr("bad.txt"));
    }
  }
  folder_.write("lost.txt", good + "4 0 0 nan 0 0 0 1\n");
  const Run without_it = run("eval '" + at("good.txt") + "' '" + at("lost.txt") + "'");
  EXPECT_EQ(without_it.exit_code, kDone) << without_it.err;
  EXPECT_THAT(without_it.out + without_it.err, HasSubstr("1 lines of NaN, which are no poses"));
  folder_.write("far.txt", good + "4 0 0 1e6 0 0 0 1\n");
  EXPECT_EQ(run("eval '" + at("far.txt") + "' '" + at("far.txt") + "'").exit_code, kDone);
}

TEST_F(Outputs, ReportSurvivesDeeplyNestedJson) {
  folder_.write("out/trajectory.txt", "1 0 0 0 0 0 0 1\n");
  const std::string deep(100'000, '[');
  folder_.write("out/run.json", "{\"input\": " + deep + std::string(100'000, ']') + "}");
  const Run refused = run("report '" + at("out") + "'");
  EXPECT_EQ(refused.exit_code, kBadInput);
  EXPECT_THAT(refused.err, HasSubstr("run.json"));
  folder_.write("out/run.json", "{\"input\": \"x\", \"fps\": 30}");
  folder_.write("out/loops/loops.json", deep);
  EXPECT_EQ(run("report '" + at("out") + "'").exit_code, kBadInput);
}

}  // namespace
}  // namespace kinloop
