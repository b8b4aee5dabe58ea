#pragma once
// One HTTP connection: one request, answered with the page or upgraded to a WebSocket.

#include <functional>
#include <memory>
#include <string>

#include "viewer/server/access.hpp"
#include "viewer/server/client_stream.hpp"
#include "viewer/server/websocket_session.hpp"

namespace kinloop {

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  /// An authorised browser asks for a WebSocket.
  struct Upgrade {
    const Request& request;
    const RequestTarget& target;  ///< with what the browser has received
    bool may_control;
  };
  /// Takes over the connection; returns false, and leaves it, if there are too many browsers.
  using UpgradeHandler = std::function<bool(ClientStream&, const Upgrade&)>;

  /// `page_gzip` is the page in gzip format.
  HttpSession(boost::asio::ip::tcp::socket socket, const AccessPolicy& rules,
              std::shared_ptr<const std::string> page_gzip, UpgradeHandler on_upgrade);

  void start();
  void close();

 private:
  void handle();
  void respond_page();
  void respond(boost::beast::http::status status, std::string_view type, std::string_view body,
               bool gzipped = false);

  ClientStream stream_;
  AccessPolicy rules_;
  std::shared_ptr<const std::string> page_gzip_;
  UpgradeHandler on_upgrade_;
  boost::beast::flat_buffer buffer_;
  boost::beast::http::request_parser<boost::beast::http::empty_body> parser_;
};

}  // namespace kinloop
