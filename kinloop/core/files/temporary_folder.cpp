#include "kinloop/core/files/temporary_folder.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/anonymous_temp_file.hpp"

namespace kinloop {
namespace {

/// Waits for the end of standard input, then removes the folder that is its argument.
constexpr const char* kScript = R"(read -r _; rm -rf -- "$1")";

/// What the shell inherits: the pipe, and nothing else, so that nobody who reads the output of this process
/// waits for it. In a session of its own it does not get the terminal's Ctrl-C.
pid_t spawn_shell(int input, const std::string& folder) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  if (posix_spawn_file_actions_init(&files) != 0) return -1;
  if (posix_spawnattr_init(&attributes) != 0) {
    posix_spawn_file_actions_destroy(&files);
    return -1;
  }
  posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
  for (const int output : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&files, output, "/dev/null", O_WRONLY, 0);
  sigset_t defaults;
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGTERM);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGDEF);
  std::string words[] = {"sh", "-c", kScript, "kinloop-remover", folder};
  char* arguments[] = {words[0].data(), words[1].data(), words[2].data(),
                       words[3].data(), words[4].data(), nullptr};
  pid_t shell = -1;
  if (posix_spawn(&shell, "/bin/sh", &files, &attributes, arguments, environ) != 0) shell = -1;
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return shell;
}

}  // namespace

TemporaryFolder::TemporaryFolder() : owner_(getpid()) {
  require_temporary_folder();
  std::string name = (std::filesystem::absolute(temporary_folder()) / "kinloop_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw OutputError(fmt::format("{}: temporary folder: {}; set TMPDIR to another folder",
                                  temporary_folder().string(), std::generic_category().message(errno)));
  }
  path_ = name;
  start_remover();
}

void TemporaryFolder::start_remover() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return;
  remover_ = spawn_shell(ends[0], path_.string());
  close(ends[0]);
  if (remover_ >= 0) {
    lifeline_ = ends[1];
  } else {
    close(ends[1]);
  }
}

TemporaryFolder::~TemporaryFolder() {
  if (getpid() == owner_) {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
    if (remover_ > 0 && waitpid(remover_, nullptr, WNOHANG) == 0) {  // still there, and still of this process
      kill(remover_, SIGTERM);
      waitpid(remover_, nullptr, 0);
    }
  }
  if (lifeline_ >= 0) close(lifeline_);
}

}  // namespace kinloop
