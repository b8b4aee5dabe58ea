#include "drivers/stream/byte_stream.hpp"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/log.hpp"

namespace kinloop {
namespace {

constexpr int kLookInterval_ms = 100;

[[noreturn]] void reject_socket(const std::filesystem::path& path, const char* what) {
  throw InputError(
      fmt::format("unix:{}: {}: {}; choose another path", path.string(), what, std::strerror(errno)));
}

/// Removes the socket of an earlier run that was killed; leaves any other file.
void remove_stale_socket(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_socket(path, ignored)) std::filesystem::remove(path, ignored);
}

}  // namespace

Descriptor::~Descriptor() {
  if (number_ >= 0) ::close(number_);
}

Descriptor::Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}

size_t ByteStream::read(std::span<uint8_t> buffer, const StopReading& stop) const {
  size_t filled = 0;
  while (filled < buffer.size() && !stop()) {
    pollfd ready{descriptor_.number(), POLLIN, 0};
    if (::poll(&ready, 1, kLookInterval_ms) <= 0) continue;
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

ByteStream accept_connection(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.empty() || name.size() >= sizeof(address.sun_path))
    throw InputError(
        fmt::format("unix:{}: the path must have 1 to {} characters", name, sizeof(address.sun_path) - 1));
  std::memcpy(address.sun_path, name.c_str(), name.size());
  remove_stale_socket(path);
  const Descriptor listener(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const auto* any_address = reinterpret_cast<const sockaddr*>(&address);
  if (::bind(listener.number(), any_address, sizeof(address)) != 0) reject_socket(path, "cannot be created");
  const bool ready = ::chmod(name.c_str(), S_IRUSR | S_IWUSR) == 0 && ::listen(listener.number(), 1) == 0;
  if (!ready) reject_socket(path, "cannot be opened");
  log::info("unix:{}: waiting for a program that sends frames", name);
  const int connection = ::accept4(listener.number(), nullptr, nullptr, SOCK_CLOEXEC);
  if (connection < 0) reject_socket(path, "no connection");
  remove_stale_socket(path);
  return ByteStream(Descriptor(connection));
}

}  // namespace kinloop
