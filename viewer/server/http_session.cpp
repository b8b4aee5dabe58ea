#include <chrono>

#include "viewer/server/client_sessions.hpp"
#include "viewer/server/viewer_page.hpp"

namespace kinloop {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::chrono::seconds kRequestTimeout{10};
constexpr std::chrono::seconds kResponseTimeout{60};  // the page, not compressed, at 100 kbit/s
constexpr uint32_t kMaxHeaderBytes = 8192;

// The page is one file: it may load nothing, and no other page may frame it, unless the rules say so. The
// referrer could leak the token. (blob: and data: are textures inside a mesh.)
constexpr const char* kContentPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self' blob: "
    "data:; "
    "img-src blob: data:; base-uri 'none'; form-action 'none'; ";
constexpr const char* kUnframed = "frame-ancestors 'none'";
constexpr const char* kFramedByLoopback =
    "frame-ancestors http://localhost:* https://localhost:* http://127.0.0.1:* https://127.0.0.1:*";

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

RequestIdentity identity_of(const Request& request, const RequestTarget& target) {
  RequestIdentity identity{view_of(request[http::field::host]), std::nullopt, target.value("token")};
  const auto origin = request.find(http::field::origin);
  if (origin != request.end()) identity.origin = view_of(origin->value());
  return identity;
}

/// Browsers send "gzip, deflate, br". Whoever gives gzip a weight, which may be zero, gets the page as it is.
bool accepts_gzip(std::string_view encodings) {
  http::ext_list list(beast::string_view(encodings.data(), encodings.size()));
  const auto gzip = list.find("gzip");
  return gzip != list.end() && gzip->second.begin() == gzip->second.end();
}

}  // namespace

HttpSession::HttpSession(boost::asio::ip::tcp::socket socket, const AccessPolicy& rules,
                         std::shared_ptr<const std::string> page_gzip, UpgradeHandler on_upgrade)
    : stream_(std::move(socket)),
      rules_(rules),
      page_gzip_(std::move(page_gzip)),
      on_upgrade_(std::move(on_upgrade)) {
  stream_.rate_policy().read_limit(kMaxReadBytesPerS);
  parser_.header_limit(kMaxHeaderBytes);
  parser_.body_limit(0);
}

void HttpSession::start() {
  stream_.expires_after(kRequestTimeout);
  http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](beast::error_code error, size_t) {
    if (!error) return self->handle();
    if (error == http::error::header_limit || error == http::error::body_limit) {
      self->respond(http::status::request_header_fields_too_large, "text/plain",
                    "request header too large\n");
    }
  });
}

void HttpSession::close() {
  stream_.close();
}

void HttpSession::handle() {
  const Request& request = parser_.get();
  const RequestTarget target = parse_target(view_of(request.target()));
  const RequestIdentity identity = identity_of(request, target);
  if (!may_view(identity, rules_)) {
    return respond(http::status::forbidden, "text/plain", "open the URL that kinloop printed\n");
  }
  if (request.method() != http::verb::get) return respond(http::status::method_not_allowed, "text/plain", "");
  if (target.path == "/") return respond_page();
  if (target.path == "/feed" && beast::websocket::is_upgrade(request)) {
    if (on_upgrade_(stream_, {request, target, may_control(identity, rules_)})) return;
    return respond(http::status::service_unavailable, "text/plain", "too many browsers; close one\n");
  }
  respond(http::status::not_found, "text/plain", "not found; the only page is /\n");
}

void HttpSession::respond_page() {
  const bool gzip = accepts_gzip(view_of(parser_.get()[http::field::accept_encoding]));
  respond(http::status::ok, "text/html; charset=utf-8", gzip ? *page_gzip_ : viewer_page(), gzip);
}

void HttpSession::respond(http::status status, std::string_view type, std::string_view body, bool gzipped) {
  using Response = http::response<http::span_body<const char>>;
  auto response = std::make_shared<Response>();
  response->result(status);
  response->set(http::field::content_type, beast::string_view(type.data(), type.size()));
  if (gzipped) response->set(http::field::content_encoding, "gzip");
  response->set(http::field::cache_control, "no-store");
  response->set("Content-Security-Policy",
                std::string(kContentPolicy) + (rules_.framed_by_loopback ? kFramedByLoopback : kUnframed));
  response->set("X-Content-Type-Options", "nosniff");
  response->set("Referrer-Policy", "no-referrer");
  response->body() = beast::span<const char>(body.data(), body.size());
  response->keep_alive(false);
  response->prepare_payload();
  stream_.expires_after(kResponseTimeout);
  http::async_write(stream_, *response, [self = shared_from_this(), response](beast::error_code, size_t) {
    beast::error_code ignored;
    self->stream_.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
  });
}

}  // namespace kinloop
