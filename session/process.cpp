#include "session/process.hpp"

#include <cstdlib>

#include <fmt/format.h>
#include <sys/resource.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "kinloop/core/errors.hpp"

namespace kinloop {

std::string program_name() {
  return "kinloop " KINLOOP_VERSION;
}

void require_stack() {
  constexpr rlim_t kKibibyte = 1024, kMinStackKib = 512;  // about 150 are used, and the libraries need some
  rlimit stack{};
  if (getrlimit(RLIMIT_STACK, &stack) != 0 || stack.rlim_cur >= kMinStackKib * kKibibyte) return;
  throw UsageError(fmt::format("the stack is limited to {} KiB, where {} are needed; use ulimit -s 8192",
                               stack.rlim_cur / kKibibyte, kMinStackKib));
}

// Images are allocated and freed by the thousand. By default glibc returns their memory to the system each
// time and gets it back page by page, which costs a third of the decoding time; and it keeps a heap for every
// thread that ever ran, which costs memory.
void retain_freed_memory() {
#ifdef __GLIBC__
  constexpr int kMebibyte = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 * kMebibyte);
  mallopt(M_TRIM_THRESHOLD, 64 * kMebibyte);
  mallopt(M_ARENA_MAX, 2);
#endif
}

void release_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace kinloop
