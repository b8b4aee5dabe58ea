#pragma once
// One connected browser: receives the parts of the scene that it has not seen, one at a time in small pieces,
// and sends commands.

#include <functional>
#include <memory>
#include <string>

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "viewer/scene/scene.hpp"
#include "viewer/server/client_stream.hpp"
#include "viewer/server/command.hpp"

namespace kinloop {

using Request = boost::beast::http::request<boost::beast::http::empty_body>;

/// What a browser has received of a scene.
struct FeedPosition {
  uint64_t seen = 0;          ///< all parts up to this version
  uint64_t part = 0;          ///< version of a part of which the connection has broken in the middle
  size_t received_bytes = 0;  ///< of that part's body
};

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

}  // namespace kinloop
