#include "apps/shared/files/python_files.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <sstream>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/shared/terminal/interrupt.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

struct ProcessEnd {
  int status = 0;  ///< as waitpid has it
  std::string printed;
};

/// Waits until there is something to read; asks the process to end if this one was interrupted.
void wait_for_output(int descriptor, pid_t process) {
  constexpr int kBetweenLooks_ms = 100;
  pollfd output{.fd = descriptor, .events = POLLIN, .revents = 0};
  while (poll(&output, 1, kBetweenLooks_ms) <= 0)
    if (interrupted()) kill(process, SIGTERM);
}

/// Reads what a process prints until it ends.
std::string read_all(int descriptor, pid_t process) {
  std::string text;
  std::array<char, 4096> block{};
  for (;;) {
    wait_for_output(descriptor, process);
    const ssize_t bytes = read(descriptor, block.data(), block.size());
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes <= 0) return text;
    text.append(block.data(), static_cast<size_t>(bytes));
  }
}

/// Runs the program that `arguments`, which end with a null pointer, begin with, and collects its output.
ProcessEnd run_process(const std::vector<char*>& arguments) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw InputError("cannot make a pipe");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  pid_t process = 0;
  const int failed = posix_spawnp(&process, arguments.front(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  ProcessEnd end;
  if (failed == 0) end.printed = read_all(ends[0], process);
  close(ends[0]);
  if (failed != 0)
    throw InputError(fmt::format("{}: cannot be started; apt install python3", arguments.front()));
  while (waitpid(process, &end.status, 0) < 0 && errno == EINTR) {
  }
  return end;
}

/// Shows the warnings among the lines that a script printed.
void show_warnings(std::istringstream printed) {
  constexpr std::string_view kWarning = "warning: ";
  for (std::string line; std::getline(printed, line);)
    if (line.starts_with(kWarning)) log::warn("{}", line.substr(kWarning.size()));
}

}  // namespace

std::filesystem::path own_program() {
  return std::filesystem::read_symlink("/proc/self/exe");
}

std::filesystem::path python_file(const std::string& name) {
  auto file = own_program().parent_path().parent_path() / "share/kinloop" / name;
  if (!std::filesystem::exists(file)) {
    throw InputError(
        fmt::format("{}: not found; install kinloop again, with its folder share/kinloop", file.string()));
  }
  return file;
}

void run_python(const std::filesystem::path& script, std::vector<std::string> words) {
  words.insert(words.begin(), {"python3", script.string()});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const auto [status, printed] = run_process(arguments);
  throw_if_interrupted();  // Ctrl-C ends the script, too
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return show_warnings(std::istringstream(printed));
  if (WIFSIGNALED(status))
    throw InputError(fmt::format("{}: ended by signal {}", script.string(), WTERMSIG(status)));
  // The last line of a traceback says what went wrong.
  const size_t end = printed.find_last_not_of('\n');
  if (end == std::string::npos) throw InputError(fmt::format("{}: failed", script.string()));
  const size_t line = printed.find_last_of('\n', end) + 1;
  throw InputError(printed.substr(line, end + 1 - line));
}

}  // namespace kinloop
