#include <cerrno>
#include <charconv>
#include <cstring>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/live_poses/pose_sender.hpp"
#include "drivers/stream/socket_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/files/writable_check.hpp"

namespace kinloop {
namespace {

constexpr std::string_view kSocketPrefix = "unix:", kUdpPrefix = "udp:";

struct UdpAddress {
  std::string host, port;
};

UdpAddress udp_address(const std::string& target) {
  const std::string address = target.substr(kUdpPrefix.size());
  const size_t colon = address.rfind(':');
  UdpAddress parsed;
  uint16_t port = 0;
  if (colon != std::string::npos) {
    parsed = {address.substr(0, colon), address.substr(colon + 1)};
    const char* end = parsed.port.data() + parsed.port.size();
    if (const auto [stop, error] = std::from_chars(parsed.port.data(), end, port);
        stop != end || error != std::errc())
      port = 0;
    if (parsed.host.starts_with('[') && parsed.host.ends_with(']'))
      parsed.host = parsed.host.substr(1, parsed.host.size() - 2);
  }
  if (parsed.host.empty() || port == 0)
    throw UsageError(
        fmt::format("--poses-to {}: expected udp:HOST:PORT with a port of 1 to 65535, e.g. "
                    "udp:localhost:5005",
                    target));
  return parsed;
}

/// Whether an error says that there is no reader, or that it is slow.
bool is_for_want_of_a_reader(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EPIPE || error == ECONNRESET ||
         error == ECONNREFUSED || error == ENXIO;
}

/// Writes whole lines to a descriptor without waiting.
class LineWriter {
 public:
  enum class Result { kTaken, kDropped, kReaderGone, kFailed };

  explicit LineWriter(Descriptor descriptor) : descriptor_(std::move(descriptor)) {
    struct stat file {};
    const bool known = ::fstat(descriptor_.number(), &file) == 0;
    is_socket_ = known && S_ISSOCK(file.st_mode);
    is_file_ = known && S_ISREG(file.st_mode);
  }

  /// errno tells why it failed.
  Result write(const std::string& line) {
    if (const Result before = send_rest(); before != Result::kTaken) return before;
    rest_ = line;
    const Result result = is_file_ ? append_rest() : send_rest();
    if (result != Result::kDropped) return result;
    if (rest_.size() < line.size()) return Result::kTaken;  // the rest goes before the next line
    rest_.clear();
    return Result::kDropped;
  }

  /// Waits a second for the reader of a line of which a part is sent. Returns false if it does not take the
  /// rest.
  bool finish() {
    constexpr int kLongestWaitMs = 1000;
    while (send_rest() == Result::kDropped) {
      pollfd ready{descriptor_.number(), POLLOUT, 0};
      if (::poll(&ready, 1, kLongestWaitMs) <= 0) return false;
    }
    return rest_.empty();
  }

 private:
  Result send_rest() {
    while (!rest_.empty()) {
      // Not all descriptors are non-blocking; POLLOUT of a pipe promises room for the 4096 bytes of PIPE_BUF.
      pollfd ready{descriptor_.number(), POLLOUT, 0};
      if (::poll(&ready, 1, 0) <= 0) return Result::kDropped;
      const ssize_t count =
          is_socket_ ? ::send(descriptor_.number(), rest_.data(), rest_.size(), MSG_DONTWAIT | MSG_NOSIGNAL)
                     : ::write(descriptor_.number(), rest_.data(), rest_.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0 && (errno == EPIPE || errno == ECONNRESET)) return Result::kReaderGone;
      if (count <= 0) return is_for_want_of_a_reader(errno) ? Result::kDropped : Result::kFailed;
      rest_.erase(0, static_cast<size_t>(count));
    }
    return Result::kTaken;
  }

  /// A disk that is full may take a part of a line, which is then taken back.
  Result append_rest() {
    const int file = descriptor_.number();
    const off_t begin = ::lseek(file, 0, (::fcntl(file, F_GETFL) & O_APPEND) != 0 ? SEEK_END : SEEK_CUR);
    const Result result = send_rest();
    if (result != Result::kFailed) return result;
    const int error = errno;
    rest_.clear();
    if (begin >= 0 && ::ftruncate(file, begin) == 0) ::lseek(file, begin, SEEK_SET);
    errno = error;
    return result;
  }

  Descriptor descriptor_;
  bool is_socket_ = false, is_file_ = false;
  std::string rest_;  // of a line of which a part is sent
};

/// Lines for one reader at a time, who may come late, leave and come back.
class ReaderLines : public LineOutput {
 public:
  /// Returns a descriptor to write to, or -1 with errno set if there is no reader.
  using Connect = std::function<Descriptor()>;

  explicit ReaderLines(Connect connect) : connect_(std::move(connect)) {}

  bool write(const std::string& line) override {
    constexpr int kReaders = 2;  // the one that has gone, and the next
    error_ = 0;
    for (int i = 0; i < kReaders; ++i) {
      if (!writer_) {
        Descriptor reader = connect_();
        if (reader.number() < 0) return fail(errno);
        writer_.emplace(std::move(reader));
      }
      const auto result = writer_->write(line);
      if (result == LineWriter::Result::kFailed) return fail(errno);
      if (result != LineWriter::Result::kReaderGone) return result == LineWriter::Result::kTaken;
      writer_.reset();
    }
    return false;
  }

  bool finish() override { return !writer_ || writer_->finish(); }
  [[nodiscard]] int error() const override { return error_; }

 private:
  bool fail(int error) {
    if (!is_for_want_of_a_reader(error)) error_ = error;
    return false;
  }

  Connect connect_;
  std::optional<LineWriter> writer_;
  int error_ = 0;
};

/// Opens a descriptor of this process anew if it is a pipe or a terminal, so that only this program's side
/// becomes non-blocking; a file keeps its position and a socket needs no mode.
Descriptor duplicate(int number) {
  struct stat file {};
  if (::fstat(number, &file) == 0 && (S_ISFIFO(file.st_mode) || S_ISCHR(file.st_mode))) {
    const int own =
        ::open(fmt::format("/proc/self/fd/{}", number).c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (own >= 0) return Descriptor(own);
  }
  return Descriptor(::fcntl(number, F_DUPFD_CLOEXEC, 0));
}

std::unique_ptr<LineOutput> open_descriptor(int number, const std::string& target) {
  const int mode = ::fcntl(number, F_GETFL);
  if (mode < 0 || (mode & O_ACCMODE) == O_RDONLY)  // see reserve_standard_descriptors
    throw InputError(fmt::format("--poses-to {}: is closed, or open for reading only; give a file", target));
  return std::make_unique<ReaderLines>([number] { return duplicate(number); });
}

std::unique_ptr<LineOutput> open_pipe(const std::filesystem::path& path) {
  return std::make_unique<ReaderLines>([path] {  // fails while nobody reads
    return Descriptor(::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  });
}

std::unique_ptr<LineOutput> open_file(const std::filesystem::path& path) {
  require_writable_file(path);
  const OutputPlace place = output_place(path);
  if (place.descriptor) return open_descriptor(*place.descriptor, path.string());
  if (place.is_stream) return open_pipe(place.target);
  constexpr mode_t kAll = 0666;  // without the bits of umask
  const auto file = std::make_shared<const Descriptor>(
      ::open(place.target.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, kAll));
  if (file->number() < 0)
    throw InputError(
        fmt::format("{}: cannot be written ({}); give another name", path.string(), std::strerror(errno)));
  return std::make_unique<ReaderLines>([file] { return duplicate(file->number()); });
}

std::unique_ptr<LineOutput> open_socket(const std::filesystem::path& path) {
  const auto listener = std::make_shared<const SocketFile>(path);
  const int number = listener->socket().number();
  ::fcntl(number, F_SETFL, ::fcntl(number, F_GETFL) | O_NONBLOCK);
  return std::make_unique<ReaderLines>([listener] { return listener->accept(); });
}

/// Returns a socket that sends to the address, or -1 with the reason.
Descriptor connect_udp(const UdpAddress& address, int family, std::string& reason) {
  addrinfo hints{};
  hints.ai_family = family;
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &found);
      error != 0) {
    reason = ::gai_strerror(error);
    return Descriptor(-1);
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, ::freeaddrinfo);
  for (const addrinfo* i = found; i != nullptr; i = i->ai_next) {
    Descriptor socket(::socket(i->ai_family, i->ai_socktype | SOCK_CLOEXEC, i->ai_protocol));
    if (socket.number() >= 0 && ::connect(socket.number(), i->ai_addr, i->ai_addrlen) == 0) return socket;
    reason = std::strerror(errno);
  }
  return Descriptor(-1);
}

std::unique_ptr<LineOutput> open_udp(const std::string& target) {
  const UdpAddress address = udp_address(target);
  std::string reason;
  // IPv4 first: a reader of localhost mostly listens to 127.0.0.1, and nobody would notice datagrams to ::1.
  for (const int family : {AF_INET, AF_INET6}) {
    Descriptor connected = connect_udp(address, family, reason);
    if (connected.number() < 0) continue;
    const auto socket = std::make_shared<const Descriptor>(std::move(connected));
    return std::make_unique<ReaderLines>([socket] { return duplicate(socket->number()); });
  }
  throw InputError(fmt::format("--poses-to {}: {}: {}; give the address of a machine that can be reached",
                               target, address.host, reason));
}

}  // namespace

void check_line_target(const std::string& target) {
  if (target.starts_with(kUdpPrefix)) static_cast<void>(udp_address(target));
}

bool is_file_target(const std::string& target) {
  return target != "-" && !target.starts_with(kSocketPrefix) && !target.starts_with(kUdpPrefix);
}

bool is_standard_output_target(const std::string& target) {
  return target == "-" || (is_file_target(target) && is_standard_output(target));
}

std::unique_ptr<LineOutput> open_line_output(const std::string& target) {
  if (target == "-") return open_descriptor(STDOUT_FILENO, target);
  if (target.starts_with(kSocketPrefix)) return open_socket(target.substr(kSocketPrefix.size()));
  if (target.starts_with(kUdpPrefix)) return open_udp(target);
  return open_file(target);
}

}  // namespace kinloop
