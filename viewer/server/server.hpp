#pragma once
// In: a scene. Out: a web page that shows it to whoever may see it. All of it happens on the thread that runs
// the io_context; a browser that is slow, dead or hostile costs one small connection.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "viewer/server/access.hpp"
#include "viewer/server/websocket_session.hpp"

namespace kinloop {

class ViewerServer {
 public:
  /// Connections at one time; more are closed as they come, so that the run keeps its file descriptors.
  static constexpr long kMaxConnections = 64;

  /// Listens at once. Throws InputError where the address cannot be had. The scene must outlive this object.
  ViewerServer(boost::asio::io_context& context, const ListenAddress& listen, const Scene& scene,
               std::function<void(Command)> on_command);

  /// Where to look, with the token if there is one.
  [[nodiscard]] std::string url() const;

  /// Sends every browser what is new.
  void send_changes();

  /// Browsers that watch.
  [[nodiscard]] size_t browsers() const;

 private:
  void accept_next();
  void retry_accept();
  void accept_websocket(boost::beast::tcp_stream stream, ConnectionSlot slot, const Request& request,
                        const RequestTarget& target);

  const Scene& scene_;
  std::function<void(Command)> on_command_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer pause_;
  AccessPolicy rules_;
  ConnectionSlot slots_;  // every connection holds a copy
  std::vector<std::weak_ptr<WebSocketSession>> browsers_;
};

}  // namespace kinloop
