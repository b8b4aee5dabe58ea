#pragma once
// A disk without space: the system refuses to let files grow beyond a few blocks.

#include <csignal>

#include <sys/resource.h>

namespace kinloop::test {

/// Returns what `call` returns while no file of this process may become larger than 4 kB.
template <class Call>
auto on_a_full_disk(const Call& call) {
  constexpr rlim_t kBytes = 4096;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{kBytes, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  auto result = call();
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  return result;
}

}  // namespace kinloop::test
