#pragma once
// One connected browser: receives the parts of the scene that it has not seen, one at a time, and sends
// commands.

#include <functional>
#include <memory>
#include <string>

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "viewer/scene/scene.hpp"
#include "viewer/server/command.hpp"

namespace kinloop {

using Request = boost::beast::http::request<boost::beast::http::empty_body>;

/// A slot among the connections, released with its last owner.
using ConnectionSlot = std::shared_ptr<void>;

class WebSocketSession : public std::enable_shared_from_this<WebSocketSession> {
 public:
  /// The browser has seen everything up to version `seen`. The scene must outlive the connection's handlers.
  WebSocketSession(boost::beast::tcp_stream stream, ConnectionSlot slot, const Scene& scene, uint64_t seen,
                   std::function<void(Command)> on_command);

  /// Accepts the upgrade request and starts sending.
  void start(const Request& request);

  /// Sends the next unseen part, unless one is still being sent.
  void send_next();

 private:
  void read_next();

  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  ConnectionSlot slot_;
  const Scene& scene_;
  uint64_t seen_;
  std::function<void(Command)> on_command_;
  boost::beast::flat_buffer received_;
  std::array<uint8_t, kHeaderBytes> header_{};
  ScenePart sending_;
  bool idle_ = false;  // open, with no send in progress
};

}  // namespace kinloop
