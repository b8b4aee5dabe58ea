#include "drivers/stream/byte_stream.hpp"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

constexpr int kLookInterval_ms = 100;

[[noreturn]] void reject_socket(const std::filesystem::path& path, const char* what) {
  throw InputError(
      fmt::format("unix:{}: {}: {}; choose another path", path.string(), what, std::strerror(errno)));
}

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

sockaddr_un address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.empty() || name.size() >= sizeof(address.sun_path))
    throw InputError(
        fmt::format("unix:{}: the path must have 1 to {} characters", name, sizeof(address.sun_path) - 1));
  std::memcpy(address.sun_path, name.c_str(), name.size());
  return address;
}

/// A socket in the file system, bound to a path until the end.
class SocketFile {
 public:
  explicit SocketFile(std::filesystem::path path)
      : path_(std::move(path)), socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_un address = address_of(path_);
    remove_stale(address);
    const auto* any_address = reinterpret_cast<const sockaddr*>(&address);
    if (::bind(socket_.number(), any_address, sizeof(address)) != 0)
      reject_socket(path_, "cannot be created");
    ::lstat(path_.c_str(), &file_);
  }
  ~SocketFile() {
    struct stat now {};
    const bool ours =
        ::lstat(path_.c_str(), &now) == 0 && now.st_dev == file_.st_dev && now.st_ino == file_.st_ino;
    if (ours) ::unlink(path_.c_str());
  }
  SocketFile(const SocketFile&) = delete;
  SocketFile& operator=(const SocketFile&) = delete;

  [[nodiscard]] const Descriptor& socket() const { return socket_; }

 private:
  /// Removes the socket of an earlier run that was killed; leaves any other file, and one that a process
  /// listens to. That answers a socket of another type with EPROTOTYPE, and does not notice.
  void remove_stale(const sockaddr_un& address) const {
    std::error_code absent;
    if (!std::filesystem::is_socket(std::filesystem::symlink_status(path_, absent))) return;
    const Descriptor probe(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const auto* any_address = reinterpret_cast<const sockaddr*>(&address);
    if (::connect(probe.number(), any_address, sizeof(address)) != 0 && errno == ECONNREFUSED)
      ::unlink(path_.c_str());
  }

  std::filesystem::path path_;
  Descriptor socket_;
  struct stat file_ {};
};

}  // namespace

Descriptor::~Descriptor() {
  if (number_ >= 0) ::close(number_);
}

Descriptor::Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}

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
  const int number = listener.socket().number();
  const bool ready = ::chmod(path.c_str(), S_IRUSR | S_IWUSR) == 0 && ::listen(number, 1) == 0;
  if (!ready) reject_socket(path, "cannot be opened");
  log::info("unix:{}: waiting for a program that sends frames", path.string());
  if (!wait_for_input(listener.socket(), stop))
    throw InputError(fmt::format("unix:{}: stopped before a program connected", path.string()));
  const int connection = ::accept4(number, nullptr, nullptr, SOCK_CLOEXEC);
  if (connection < 0) reject_socket(path, "no connection");
  return ByteStream(Descriptor(connection));
}

}  // namespace kinloop
