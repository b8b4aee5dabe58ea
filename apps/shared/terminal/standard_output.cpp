#include "apps/shared/terminal/standard_output.hpp"

#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/text/escaped.hpp"

namespace kinloop {

void reserve_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) >= 0) continue;
    // The wrong way round: using it remains an error. The lowest free number is the one that is closed.
    static_cast<void>(open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

std::FILE* message_stream(const std::filesystem::path& output) {
  return is_standard_output(output) ? stderr : stdout;
}

void print_text(const std::string& text, std::FILE* stream) {
  std::fputs(escaped(text, "\n\t").c_str(), stream);
}

int flush_standard_output() {
  if (std::fflush(stdout) != 0) return errno;
  return std::ferror(stdout) != 0 ? EIO : 0;
}

}  // namespace kinloop
