#pragma once
// In: what a request says of itself. Out: whether it may see the run.
//
// On this machine alone (127.0.0.1) any program may ask; web pages of others may not, though they reach the
// server through the browser: their Origin gives them away, and a name of theirs that is made to point here
// (DNS rebinding) is not a name of this machine. On another address every request needs the token of the URL.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace kinloop {

struct AccessPolicy {
  bool loopback_only = true;
  std::string token;  ///< that the URL must carry; empty: none
};

/// What a request says of itself.
struct RequestIdentity {
  std::string_view host;                   ///< header Host
  std::optional<std::string_view> origin;  ///< header Origin, which browsers send with every WebSocket
  std::string_view token;                  ///< of the URL
};

bool is_authorized(const RequestIdentity& identity, const AccessPolicy& rules);

/// A path with its query, "/feed?since=7&token=ab". Nothing is decoded: no name or value of ours needs it.
struct RequestTarget {
  std::string_view path;
  std::map<std::string_view, std::string_view> query;

  /// The value, or nothing.
  [[nodiscard]] std::string_view value(std::string_view name) const;
};

RequestTarget parse_target(std::string_view target);

/// A token that cannot be guessed: 128 random bits as hex digits.
std::string random_token();

/// Where to listen.
struct ListenAddress {
  std::string address = "127.0.0.1";
  uint16_t port = 8080;
};

/// "", "PORT" or "ADDRESS:PORT" (an IPv6 address in brackets). Throws UsageError when it is none of them.
ListenAddress parse_listen_address(const std::string& text);

/// Whether it can be reached from this machine alone. Throws UsageError where it is not an IP address.
bool is_loopback_address(const ListenAddress& listen);

}  // namespace kinloop
