#include "viewer/server/server.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <limits>
#include <map>

#include <boost/asio/ip/host_name.hpp>
#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "viewer/gzip.hpp"
#include "viewer/server/viewer_page.hpp"

namespace kinloop {

void PendingRequests::add(const std::shared_ptr<HttpSession>& session,
                          const boost::asio::ip::address& client) {
  std::erase_if(pending_, [](const Pending& pending) { return pending.session.expired(); });
  if (pending_.size() >= kMax) close_one();
  pending_.push_back({session, client});
}

void PendingRequests::close_one() {
  std::map<boost::asio::ip::address, size_t> count;
  for (const Pending& pending : pending_) ++count[pending.client];
  const auto most = std::max_element(count.begin(), count.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto oldest = std::find_if(pending_.begin(), pending_.end(),
                                   [&](const Pending& pending) { return pending.client == most->first; });
  if (const auto session = oldest->session.lock()) session->close();
  pending_.erase(oldest);
}

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

uint64_t number_in(std::string_view text) {
  uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

/// What the browser says that it has received; nothing if of another run.
FeedPosition received_by(const RequestTarget& target, const Scene& scene) {
  if (target.value("run") != scene.run()) return {};
  return {number_in(target.value("since")), number_in(target.value("part")),
          number_in(target.value("bytes"))};
}

}  // namespace

ViewerServer::ViewerServer(asio::io_context& context, const ListenAddress& listen, const Scene& scene,
                           std::function<void(const Command&)> on_command)
    : scene_(scene),
      on_command_(std::move(on_command)),
      acceptor_(listen_at(context, listen)),
      pause_(context),
      page_gzip_(std::make_shared<const std::string>(gzipped(viewer_page()))) {
  rules_ = {is_loopback_address(listen), random_token()};
  rules_.framed_by_loopback = rules_.loopback_only && listen.framed_by_loopback;
  accept_next();
}

std::string ViewerServer::url() const {
  const auto at = acceptor_.local_endpoint();
  const std::string address =
      at.address().is_unspecified() ? asio::ip::host_name() : at.address().to_string();
  return fmt::format("http://{}:{}/?token={}",
                     address.find(':') == std::string::npos ? address : "[" + address + "]", at.port(),
                     rules_.token);
}

void ViewerServer::accept_next() {
  acceptor_.async_accept([this](boost::system::error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) return retry_accept();
    answer(std::move(socket));
    accept_next();
  });
}

void ViewerServer::answer(tcp::socket socket) {
  boost::system::error_code error;
  const auto client = socket.remote_endpoint(error).address();
  if (error) return;  // disconnected again
  const auto session =
      std::make_shared<HttpSession>(std::move(socket), rules_, page_gzip_,
                                    [this](ClientStream& stream, const HttpSession::Upgrade& upgrade) {
                                      return accept_websocket(stream, upgrade);
                                    });
  requests_.add(session, client);
  session->start();
}

/// The process is out of descriptors or the like; an immediate retry would fail, too.
void ViewerServer::retry_accept() {
  constexpr std::chrono::milliseconds kPause{100};
  pause_.expires_after(kPause);
  pause_.async_wait([this](boost::system::error_code error) {
    if (!error) accept_next();
  });
}

bool ViewerServer::accept_websocket(ClientStream& stream, const HttpSession::Upgrade& upgrade) {
  std::erase_if(browsers_, [](const auto& browser) { return browser.expired(); });
  const auto spectators = std::count_if(browsers_.begin(), browsers_.end(), [](const auto& browser) {
    const auto watching = browser.lock();
    return watching && !watching->may_control();
  });
  if (browsers_.size() >= kMaxBrowsers) return false;
  if (!upgrade.may_control && static_cast<size_t>(spectators) >= kMaxSpectators) return false;
  const auto browser = std::make_shared<WebSocketSession>(
      std::move(stream), scene_, received_by(upgrade.target, scene_),
      upgrade.may_control ? on_command_ : std::function<void(const Command&)>());
  browsers_.push_back(browser);
  browser->start(upgrade.request);
  return true;
}

void ViewerServer::send_changes() {
  std::erase_if(browsers_, [](const auto& browser) { return browser.expired(); });
  for (const auto& browser : browsers_) {
    if (const auto watching = browser.lock()) watching->send_next();
  }
}

uint64_t ViewerServer::sent_version() const {
  uint64_t least = std::numeric_limits<uint64_t>::max();
  for (const auto& browser : browsers_) {
    if (const auto watching = browser.lock()) least = std::min(least, watching->sent_version());
  }
  return least;
}

size_t ViewerServer::browsers() const {
  return static_cast<size_t>(std::count_if(browsers_.begin(), browsers_.end(),
                                           [](const auto& browser) { return !browser.expired(); }));
}

}  // namespace kinloop
