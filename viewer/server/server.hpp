#pragma once
// In: a scene. Out: a web page that shows it to authorised clients. Everything runs on the thread of the
// io_context; a slow, dead or hostile browser costs one small connection.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "viewer/server/access.hpp"
#include "viewer/server/http_session.hpp"
#include "viewer/server/pending_requests.hpp"
#include "viewer/server/websocket_session.hpp"

namespace kinloop {

class ViewerServer {
 public:
  /// Maximum number of browsers, and of those without the token, so that the run keeps its file descriptors
  /// and those with the token find a place.
  static constexpr size_t kMaxBrowsers = 32, kMaxSpectators = 16;

  /// Starts listening. Throws InputError if the address is not available. The scene must outlive this object.
  ViewerServer(boost::asio::io_context& context, const ListenAddress& listen, const Scene& scene,
               std::function<void(Command)> on_command);

  /// URL of the page, with the token if there is one.
  [[nodiscard]] std::string url() const;

  /// Sends the changes to every browser.
  void send_changes();

  /// Number of connected browsers.
  [[nodiscard]] size_t browsers() const;

 private:
  void accept_next();
  void retry_accept();
  void answer(boost::asio::ip::tcp::socket socket);
  bool accept_websocket(boost::beast::tcp_stream& stream, const HttpSession::Upgrade& upgrade);

  const Scene& scene_;
  std::function<void(Command)> on_command_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer pause_;
  AccessPolicy rules_;
  PendingRequests requests_;
  std::vector<std::weak_ptr<WebSocketSession>> browsers_;
};

}  // namespace kinloop
