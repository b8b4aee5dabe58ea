#include <boost/asio/io_context.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"
#include "viewer/server/client_sessions.hpp"

namespace kinloop::fuzz {
namespace {

using boost::asio::ip::tcp;

/// A browser that sends bytes and reads all answers, at the other end of a pair of sockets.
class Browser {
 public:
  Browser() {
    int ends[2] = {};
    require(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) == 0, "socketpair");
    own_end_ = ends[0];
    auto upgrade = [this](ClientStream& stream, const HttpSession::Upgrade& request) {
      std::make_shared<WebSocketSession>(std::move(stream), scene_, FeedPosition{}, [](const Command&) {
      })->start(request.request);
      return true;
    };
    const AccessPolicy loopback;
    std::make_shared<HttpSession>(tcp::socket(context_, tcp::v4(), ends[1]), loopback,
                                  std::make_shared<const std::string>(), upgrade)
        ->start();
  }
  ~Browser() {
    ::close(own_end_);
    context_.poll();
  }
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  void send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(own_end_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent > 0) bytes.remove_prefix(static_cast<size_t>(sent));
      if (!serve() && sent <= 0) return;
    }
  }

  /// No more bytes will come.
  void finish() {
    ::shutdown(own_end_, SHUT_WR);
    while (serve()) {
    }
  }

 private:
  /// Returns whether anything happened.
  bool serve() {
    char answer[1 << 14];
    const bool handled = context_.poll() > 0;
    return ::recv(own_end_, answer, sizeof answer, 0) > 0 || handled;
  }

  Scene scene_{"run"};
  boost::asio::io_context context_{1};
  int own_end_ = -1;
};

}  // namespace

void read_http_bytes(std::string_view bytes) {
  Browser browser;
  browser.send(bytes);
  browser.finish();
}

/// The bytes are the frames after a correct request.
void read_websocket_bytes(std::string_view bytes) {
  Browser browser;
  browser.send(
      "GET /feed HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n");
  browser.send(bytes);
  browser.finish();
}

}  // namespace kinloop::fuzz
