#pragma once
// In: a scene. Out: a web page that shows it to authorised clients. Everything runs on the thread of the
// io_context; a slow, dead or hostile browser costs one small connection.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "viewer/server/access.hpp"
#include "viewer/server/client_sessions.hpp"

namespace kinloop {

/// The connections that wait for their request to be read or answered. Silent and slow ones give way to new
/// ones, so that they cannot lock anybody out.
class PendingRequests {
 public:
  static constexpr size_t kMax = 32;

  /// If there are already kMax, the oldest of the address that has the most is closed.
  void add(const std::shared_ptr<HttpSession>& session, const boost::asio::ip::address& client);

 private:
  struct Pending {
    std::weak_ptr<HttpSession> session;
    boost::asio::ip::address client;
  };

  void close_one();

  std::vector<Pending> pending_;  ///< the oldest first
};

class ViewerServer {
 public:
  /// Maximum number of browsers, and of those without the token, so that the run keeps its file descriptors
  /// and those with the token find a place.
  static constexpr size_t kMaxBrowsers = 32, kMaxSpectators = 16;

  /// Starts listening. Throws InputError if the address is not available. The scene must outlive this object.
  ViewerServer(boost::asio::io_context& context, const ListenAddress& listen, const Scene& scene,
               std::function<void(const Command&)> on_command);

  /// URL of the page, with the token if there is one.
  [[nodiscard]] std::string url() const;

  /// Sends the changes to every browser.
  void send_changes();

  /// Returns the version up to which every browser has been sent all parts; the highest number without
  /// browsers.
  [[nodiscard]] uint64_t sent_version() const;

  /// Number of connected browsers.
  [[nodiscard]] size_t browsers() const;

 private:
  void accept_next();
  void retry_accept();
  void answer(boost::asio::ip::tcp::socket socket);
  bool accept_websocket(ClientStream& stream, const HttpSession::Upgrade& upgrade);

  const Scene& scene_;
  std::function<void(const Command&)> on_command_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer pause_;
  AccessPolicy rules_;
  std::shared_ptr<const std::string> page_gzip_;
  PendingRequests requests_;
  std::vector<std::weak_ptr<WebSocketSession>> browsers_;
};

}  // namespace kinloop
