#pragma once
// The connection to a client: one HTTP request, answered with the page or upgraded to a WebSocket, over which
// the browser receives the scene and sends commands.

#include <functional>
#include <memory>
#include <string>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/rate_policy.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "viewer/scene/scene.hpp"
#include "viewer/server/access.hpp"
#include "viewer/server/command.hpp"

namespace kinloop {

/// It is read slowly, so that a flood of any kind (requests, pings, empty fragments, of which Beast takes any
/// number) costs next to nothing and backs up in the client.
using ClientStream = boost::beast::basic_stream<boost::asio::ip::tcp, boost::asio::any_io_executor,
                                                boost::beast::simple_rate_policy>;

/// Bytes that are read per second from a client. A page sends less than 1 KiB/s, the longest request has 8
/// KiB.
constexpr size_t kMaxReadBytesPerS = 1 << 14;

using Request = boost::beast::http::request<boost::beast::http::empty_body>;

/// What a browser has received of a scene.
struct FeedPosition {
  uint64_t seen = 0;          ///< all parts up to this version
  uint64_t part = 0;          ///< version of a part of which the connection has broken in the middle
  size_t received_bytes = 0;  ///< of that part's body
};

/// One connected browser: receives the parts of the scene that it has not seen, one at a time in small
/// pieces, and sends commands.
class WebSocketSession : public std::enable_shared_from_this<WebSocketSession> {
 public:
  /// `on_command` is empty if the browser may not control the run. The scene must outlive the connection's
  /// handlers.
  WebSocketSession(ClientStream stream, const Scene& scene, const FeedPosition& position,
                   std::function<void(const Command&)> on_command);

  /// Accepts the upgrade request and starts sending.
  void start(const Request& request);

  /// Sends what the browser has not seen, unless that is in progress.
  void send_next();

  /// The version up to which all parts have been sent.
  [[nodiscard]] uint64_t sent_version() const { return position_.seen; }

  [[nodiscard]] bool may_control() const { return on_command_ != nullptr; }

 private:
  bool begin_part();
  void send_piece();
  void read_next();
  void take_command(const Command& command);
  void refuse(const char* reason);

  boost::beast::websocket::stream<ClientStream> socket_;
  const Scene& scene_;
  FeedPosition position_;
  std::function<void(const Command&)> on_command_;
  CommandRate rate_;
  boost::beast::flat_buffer received_;
  std::array<uint8_t, kHeaderBytes> header_{};
  ScenePart sending_;      // no body: none
  size_t sent_bytes_ = 0;  // of its body
  bool idle_ = false;      // open, with no send in progress
};

/// One HTTP connection: one request, answered with the page or upgraded to a WebSocket.
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
