#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "drivers/stream/frame_protocol.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

constexpr int kLookInterval_ms = 100;

bool requested(const StopRequest& stop) {
  return stop && stop();
}

/// Waits for data or a connection; returns false if `stop` said so before.
bool wait_for_input(const Descriptor& descriptor, const StopRequest& stop) {
  pollfd ready{descriptor.number(), POLLIN, 0};
  while (!requested(stop)) {
    if (::poll(&ready, 1, kLookInterval_ms) > 0) return true;
  }
  return false;
}

}  // namespace

size_t ByteStream::read(std::span<uint8_t> buffer, const StopRequest& stop) const {
  size_t filled = 0;
  while (filled < buffer.size() && wait_for_input(descriptor_, stop)) {
    const ssize_t count = ::read(descriptor_.number(), buffer.data() + filled, buffer.size() - filled);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) break;
    filled += static_cast<size_t>(count);
  }
  return filled;
}

ByteStream open_standard_input() {
  if (::isatty(STDIN_FILENO) != 0)
    throw UsageError("-: standard input is a terminal; pipe frames into it, see docs/protocol.md");
  return ByteStream(Descriptor(::dup(STDIN_FILENO)));
}

ByteStream accept_connection(const std::filesystem::path& path, const StopRequest& stop) {
  const SocketFile listener(path);
  log::info("unix:{}: waiting for a program that sends frames", path.string());
  if (!wait_for_input(listener.socket(), stop))
    throw InputError(fmt::format("unix:{}: stopped before a program connected", path.string()));
  Descriptor connection = listener.accept();
  if (connection.number() < 0)
    throw InputError(
        fmt::format("unix:{}: no connection: {}; connect again", path.string(), std::strerror(errno)));
  return ByteStream(std::move(connection));
}

}  // namespace kinloop
