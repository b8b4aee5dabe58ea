#pragma once
// A Unix socket in the file system, to which another program connects.

#include <filesystem>
#include <utility>

#include <sys/stat.h>

namespace kinloop {

/// An open file, closed at the end; -1: none.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

/// Creates a socket that only this user may connect to, and removes it at the end. The socket of a run that
/// was killed is replaced. Throws InputError if it cannot be created, as where another process listens.
class SocketFile {
 public:
  explicit SocketFile(std::filesystem::path path);
  ~SocketFile();
  SocketFile(const SocketFile&) = delete;
  SocketFile& operator=(const SocketFile&) = delete;

  [[nodiscard]] const Descriptor& socket() const { return socket_; }

  /// Returns the next connection, for which it waits unless the socket is non-blocking; -1, with errno set,
  /// if there is none.
  [[nodiscard]] Descriptor accept() const;

 private:
  std::filesystem::path path_;
  Descriptor socket_;
  struct stat file_ {};
};

}  // namespace kinloop
