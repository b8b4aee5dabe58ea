#pragma once
// One HTTP connection: one request, answered with the page, or handed on as the WebSocket of a browser.

#include <functional>
#include <memory>

#include "viewer/server/access.hpp"
#include "viewer/server/browser.hpp"

namespace kinloop {

class Visit : public std::enable_shared_from_this<Visit> {
 public:
  /// Takes over the connection of a browser that may watch; the target says how far it was.
  using Admit = std::function<void(boost::beast::tcp_stream, Seat, const Request&, const Target&)>;

  Visit(boost::asio::ip::tcp::socket socket, Seat seat, const AccessRules& rules, Admit admit);

  void start();

 private:
  void handle();
  void answer(boost::beast::http::status status, std::string_view type, std::string_view body);

  boost::beast::tcp_stream stream_;
  Seat seat_;
  AccessRules rules_;
  Admit admit_;
  boost::beast::flat_buffer buffer_;
  boost::beast::http::request_parser<boost::beast::http::empty_body> parser_;
};

}  // namespace kinloop
