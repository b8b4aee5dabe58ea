#include <algorithm>
#include <chrono>

#include "viewer/server/client_sessions.hpp"

namespace kinloop {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

constexpr size_t kLongestCommandBytes = 1024;
// A ping waits for the piece that is being sent and for the kernel's buffer. Together they take 16 s at
// 200 kbit/s, so that the answer comes within the idle timeout.
constexpr size_t kPieceBytes = 1 << 17;
constexpr int kSendBufferBytes = 1 << 17;
constexpr std::chrono::seconds kHandshakeTimeout{10};
constexpr std::chrono::seconds kIdleTimeout{60};  // a ping is sent after half of it

}  // namespace

WebSocketSession::WebSocketSession(ClientStream stream, const Scene& scene, const FeedPosition& position,
                                   std::function<void(const Command&)> on_command)
    : socket_(std::move(stream)), scene_(scene), position_(position), on_command_(std::move(on_command)) {}

void WebSocketSession::start(const Request& request) {
  auto& stream = beast::get_lowest_layer(socket_);
  beast::error_code ignored;
  stream.socket().set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
  stream.socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  stream.expires_never();  // the WebSocket handles timeouts from here on
  socket_.set_option(websocket::stream_base::timeout{kHandshakeTimeout, kIdleTimeout, true});
  socket_.read_message_max(kLongestCommandBytes);
  socket_.binary(true);
  socket_.auto_fragment(false);  // avoids copying into frames of 4 KiB
  socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
    if (error) return;
    self->idle_ = true;
    self->send_next();
    self->read_next();
  });
}

void WebSocketSession::send_next() {
  if (idle_ && (sending_.body || begin_part())) send_piece();
}

/// Chooses the next unseen part, and continues where the connection has broken; false if there is none.
bool WebSocketSession::begin_part() {
  auto part = scene_.next_after(position_.seen);
  if (!part) return false;
  sending_ = std::move(*part);
  const bool resumes = sending_.version == position_.part && position_.received_bytes < sending_.body->size();
  sent_bytes_ = resumes ? position_.received_bytes : 0;
  return true;
}

void WebSocketSession::send_piece() {
  idle_ = false;
  const WireBytes& body = *sending_.body;
  const size_t bytes = std::min(kPieceBytes, body.size() - sent_bytes_);
  header_ = encode_header({sending_.kind, sending_.index, sending_.version, body.size(), sent_bytes_});
  const std::array<asio::const_buffer, 2> message = {asio::buffer(header_),
                                                     asio::buffer(body.data() + sent_bytes_, bytes)};
  socket_.async_write(message, [self = shared_from_this(), bytes](beast::error_code error, size_t) {
    if (error) return;
    self->idle_ = true;
    self->sent_bytes_ += bytes;
    if (self->sent_bytes_ == self->sending_.body->size()) {
      self->position_.seen = self->sending_.version;
      self->sending_ = {};
    }
    self->send_next();
  });
}

void WebSocketSession::read_next() {
  socket_.async_read(received_, [self = shared_from_this()](beast::error_code error, size_t) {
    if (error) return;  // disconnected, or a malformed or too long frame: the stream has closed itself
    const auto bytes = self->received_.cdata();
    const auto command = parse_command({static_cast<const char*>(bytes.data()), bytes.size()});
    self->received_.clear();
    if (!command) return beast::get_lowest_layer(self->socket_).close();
    self->take_command(*command);
  });
}

void WebSocketSession::take_command(const Command& command) {
  if (!may_control()) return refuse("Open the URL that kinloop printed to control the run.");
  if (!rate_.allows(std::chrono::steady_clock::now())) return refuse("Too many commands.");
  on_command_(command);
  read_next();
}

/// Closes the connection; the page shows the reason.
void WebSocketSession::refuse(const char* reason) {
  socket_.async_close({websocket::close_code::policy_error, reason},
                      [self = shared_from_this()](beast::error_code) {});
}

}  // namespace kinloop
