#pragma once
// One HTTP connection: one request, answered with the page or upgraded to a WebSocket.

#include <functional>
#include <memory>

#include "viewer/server/access.hpp"
#include "viewer/server/websocket_session.hpp"

namespace kinloop {

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  /// Takes over the connection of an authorised browser; the target contains the last version it has seen.
  using UpgradeHandler =
      std::function<void(boost::beast::tcp_stream, ConnectionSlot, const Request&, const RequestTarget&)>;

  HttpSession(boost::asio::ip::tcp::socket socket, ConnectionSlot slot, const AccessPolicy& rules,
              UpgradeHandler on_upgrade);

  void start();

 private:
  void handle();
  void respond(boost::beast::http::status status, std::string_view type, std::string_view body);

  boost::beast::tcp_stream stream_;
  ConnectionSlot slot_;
  AccessPolicy rules_;
  UpgradeHandler on_upgrade_;
  boost::beast::flat_buffer buffer_;
  boost::beast::http::request_parser<boost::beast::http::empty_body> parser_;
};

}  // namespace kinloop
