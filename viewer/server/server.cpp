#include "viewer/server/server.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>

#include <boost/asio/ip/host_name.hpp>
#include <fmt/format.h>

#include "kinloop/base/errors.hpp"
#include "viewer/server/http_session.hpp"

namespace kinloop {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

tcp::acceptor listen_at(asio::io_context& context, const ListenAddress& listen) {
  const tcp::endpoint endpoint(asio::ip::make_address(listen.address), listen.port);
  tcp::acceptor acceptor(context);
  try {
    acceptor.open(endpoint.protocol());
    acceptor.set_option(tcp::acceptor::reuse_address(true));
    acceptor.bind(endpoint);
    acceptor.listen();
  } catch (const boost::system::system_error& error) {
    throw InputError(
        fmt::format("the viewer cannot listen at {} port {} ({}); choose another port, --viewer PORT, "
                    "or 0 for any free port",
                    listen.address, listen.port, error.code().message()));
  }
  return acceptor;
}

/// The last version that the browser has seen, if of this run.
uint64_t version_seen(const RequestTarget& target, const Scene& scene) {
  uint64_t version = 0;
  const std::string_view since = target.value("since");
  if (target.value("run") == scene.run()) std::from_chars(since.data(), since.data() + since.size(), version);
  return version;
}

}  // namespace

ViewerServer::ViewerServer(asio::io_context& context, const ListenAddress& listen, const Scene& scene,
                           std::function<void(Command)> on_command)
    : scene_(scene),
      on_command_(std::move(on_command)),
      acceptor_(listen_at(context, listen)),
      pause_(context),
      slots_(std::make_shared<int>()) {
  rules_.loopback_only = is_loopback_address(listen);
  if (!rules_.loopback_only) rules_.token = random_token();
  accept_next();
}

std::string ViewerServer::url() const {
  const auto at = acceptor_.local_endpoint();
  const std::string address =
      at.address().is_unspecified() ? asio::ip::host_name() : at.address().to_string();
  return fmt::format("http://{}:{}/{}",
                     address.find(':') == std::string::npos ? address : "[" + address + "]", at.port(),
                     rules_.token.empty() ? "" : "?token=" + rules_.token);
}

void ViewerServer::accept_next() {
  acceptor_.async_accept([this](boost::system::error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) return retry_accept();
    if (slots_.use_count() <= kMaxConnections) {
      auto accept_websocket = [this](auto&&... arguments) {
        this->accept_websocket(std::forward<decltype(arguments)>(arguments)...);
      };
      std::make_shared<HttpSession>(std::move(socket), slots_, rules_, accept_websocket)->start();
    }
    accept_next();  // the socket is closed here if it was not handed over
  });
}

/// The process is out of descriptors or the like; an immediate retry would fail, too.
void ViewerServer::retry_accept() {
  constexpr std::chrono::milliseconds kPause{100};
  pause_.expires_after(kPause);
  pause_.async_wait([this](boost::system::error_code error) {
    if (!error) accept_next();
  });
}

void ViewerServer::accept_websocket(boost::beast::tcp_stream stream, ConnectionSlot slot,
                                    const Request& request, const RequestTarget& target) {
  const auto browser = std::make_shared<WebSocketSession>(std::move(stream), std::move(slot), scene_,
                                                          version_seen(target, scene_), on_command_);
  browsers_.push_back(browser);
  browser->start(request);
}

void ViewerServer::send_changes() {
  std::erase_if(browsers_, [](const auto& browser) { return browser.expired(); });
  for (const auto& browser : browsers_) {
    if (const auto watching = browser.lock()) watching->send_next();
  }
}

size_t ViewerServer::browsers() const {
  return static_cast<size_t>(std::count_if(browsers_.begin(), browsers_.end(),
                                           [](const auto& browser) { return !browser.expired(); }));
}

}  // namespace kinloop
