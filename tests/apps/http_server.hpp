#pragma once
// A local HTTP server of a few files, for tests of downloads: supports HEAD, GET and ranges, and can hang up
// early.

#include <atomic>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace kinloop::test {

class HttpServer {
 public:
  /// Serves `content` at `path`; everything else is not found.
  HttpServer(const std::string& path, const std::string& content)
      : HttpServer(std::map<std::string, std::string>{{path, content}}) {}
  /// Serves files: contents by path.
  explicit HttpServer(std::map<std::string, std::string> files) : files_(std::move(files)) {
    socket_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof address;
    auto* plain = reinterpret_cast<sockaddr*>(&address);
    if (bind(socket_, plain, length) != 0 || listen(socket_, 4) != 0 ||
        getsockname(socket_, plain, &length) != 0) {
      throw std::runtime_error("no server");
    }
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this] { serve(); });
  }
  ~HttpServer() {
    shutdown(socket_, SHUT_RDWR);
    close(socket_);
  }
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] std::string address() const { return fmt::format("http://127.0.0.1:{}", port_); }

  std::atomic<size_t> hang_up_after = std::string::npos;  ///< bytes of content per response
  std::atomic<size_t> last_range_begin = 0;               ///< of the last GET
  std::atomic<size_t> downloads = 0;                      ///< GETs of files that there are

 private:
  void serve() {
    while (true) {
      const int client = accept(socket_, nullptr, nullptr);
      if (client < 0) return;
      answer(client);
      close(client);
    }
  }

  void answer(int client) {
    std::string request(8192, '\0');
    request.resize(
        static_cast<size_t>(std::max<ssize_t>(0, recv(client, request.data(), request.size(), 0))));
    const bool head = request.starts_with("HEAD");
    const size_t path_begin = request.find(' ') + 1;
    const auto file = files_.find(request.substr(path_begin, request.find(' ', path_begin) - path_begin));
    if (file == files_.end()) {
      return send_all(client, "HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
    }
    const std::string& content = file->second;
    if (!head) ++downloads;
    size_t begin = 0;
    if (const size_t range = request.find("Range: bytes="); range != std::string::npos) {
      begin = std::stoul(request.substr(range + 13));
    }
    if (!head) last_range_begin = begin;
    send_all(client, fmt::format("HTTP/1.1 {}\r\nContent-Length: {}\r\nContent-Range: bytes {}-{}/{}\r\n"
                                 "Connection: close\r\n\r\n",
                                 begin > 0 ? "206 Partial Content" : "200 OK", content.size() - begin, begin,
                                 content.size() - 1, content.size()));
    if (!head) send_all(client, content.substr(begin, hang_up_after));
  }

  static void send_all(int client, const std::string& bytes) {
    for (size_t sent = 0; sent < bytes.size();) {
      const ssize_t now = send(client, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (now <= 0) return;
      sent += static_cast<size_t>(now);
    }
  }

  std::map<std::string, std::string> files_;
  int socket_ = -1;
  uint16_t port_ = 0;
  std::jthread thread_;
};

}  // namespace kinloop::test
