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

class WebSocketSession : public std::enable_shared_from_this<WebSocketSession> {
 public:
  /// The browser has seen everything up to version `seen`. `on_command` is empty if it may not control the
  /// run. The scene must outlive the connection's handlers.
  WebSocketSession(boost::beast::tcp_stream stream, const Scene& scene, uint64_t seen,
                   std::function<void(Command)> on_command);

  /// Accepts the upgrade request and starts sending.
  void start(const Request& request);

  /// Sends the next unseen part, unless one is still being sent.
  void send_next();

  [[nodiscard]] bool may_control() const { return on_command_ != nullptr; }

 private:
  void read_next();
  void take_command(Command command);
  void refuse(const char* reason);

  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  const Scene& scene_;
  uint64_t seen_;
  std::function<void(Command)> on_command_;
  CommandRate rate_;
  boost::beast::flat_buffer received_;
  std::array<uint8_t, kHeaderBytes> header_{};
  ScenePart sending_;
  bool idle_ = false;  // open, with no send in progress
};

}  // namespace kinloop
