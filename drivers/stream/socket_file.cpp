#include "drivers/stream/socket_file.hpp"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

[[noreturn]] void reject_socket(const std::filesystem::path& path, const char* what) {
  throw InputError(
      fmt::format("unix:{}: {}: {}; choose another path", path.string(), what, std::strerror(errno)));
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

/// Removes the socket of an earlier run that was killed; leaves any other file, and one that a process
/// listens to. That answers a socket of another type with EPROTOTYPE, and does not notice.
void remove_stale(const std::filesystem::path& path, const sockaddr_un& address) {
  std::error_code absent;
  if (!std::filesystem::is_socket(std::filesystem::symlink_status(path, absent))) return;
  const Descriptor probe(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const auto* any_address = reinterpret_cast<const sockaddr*>(&address);
  if (::connect(probe.number(), any_address, sizeof(address)) != 0 && errno == ECONNREFUSED)
    ::unlink(path.c_str());
}

}  // namespace

Descriptor::~Descriptor() {
  if (number_ >= 0) ::close(number_);
}

Descriptor::Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}

SocketFile::SocketFile(std::filesystem::path path)
    : path_(std::move(path)), socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const sockaddr_un address = address_of(path_);
  remove_stale(path_, address);
  const auto* any_address = reinterpret_cast<const sockaddr*>(&address);
  if (::bind(socket_.number(), any_address, sizeof(address)) != 0) reject_socket(path_, "cannot be created");
  ::lstat(path_.c_str(), &file_);
  const bool ready = ::chmod(path_.c_str(), S_IRUSR | S_IWUSR) == 0 && ::listen(socket_.number(), 1) == 0;
  if (ready) return;
  const int error = errno;
  ::unlink(path_.c_str());  // there is no object yet whose destructor would
  errno = error;
  reject_socket(path_, "cannot be opened");
}

SocketFile::~SocketFile() {
  struct stat now {};
  const bool ours =
      ::lstat(path_.c_str(), &now) == 0 && now.st_dev == file_.st_dev && now.st_ino == file_.st_ino;
  if (ours) ::unlink(path_.c_str());
}

Descriptor SocketFile::accept() const {
  return Descriptor(::accept4(socket_.number(), nullptr, nullptr, SOCK_CLOEXEC));
}

}  // namespace kinloop
