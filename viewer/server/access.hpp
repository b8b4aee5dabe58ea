#pragma once
// In: the identity in a request. Out: whether it may see the run, and whether it may control it.
// On the loopback address (127.0.0.1) any local program may see the run. Web pages from elsewhere may not,
// although the browser could connect for them: they are recognised by their Origin, and by a Host that is not
// a name of this machine (DNS rebinding). The token of the URL is needed to control the run, since other
// users of the machine can connect, too; on any other address it is needed to see the run.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace kinloop {

struct AccessPolicy {
  bool loopback_only = true;
  std::string token;                ///< of the URL that kinloop prints
  bool framed_by_loopback = false;  ///< pages of this machine, such as a notebook, may frame the page
};

/// The identity in a request.
struct RequestIdentity {
  std::string_view host;  ///< header Host
  std::optional<std::string_view>
      origin;              ///< header Origin, which browsers send with every WebSocket request
  std::string_view token;  ///< of the URL
};

bool may_view(const RequestIdentity& identity, const AccessPolicy& rules);
bool may_control(const RequestIdentity& identity, const AccessPolicy& rules);

/// A path with its query, "/feed?since=7&token=ab". Nothing is percent-decoded; no name or value requires it.
struct RequestTarget {
  std::string_view path;
  std::map<std::string_view, std::string_view> query;

  /// Returns the value of a query parameter, or an empty string.
  [[nodiscard]] std::string_view value(std::string_view name) const;
};

RequestTarget parse_target(std::string_view target);

/// Returns an unguessable token: 128 random bits as hex digits.
std::string random_token();

/// Address and port of the server.
struct ListenAddress {
  std::string address = "127.0.0.1";
  uint16_t port = 8080;
  bool framed_by_loopback = false;  ///< AccessPolicy::framed_by_loopback
};

/// Parses "", "PORT" or "ADDRESS:PORT" (an IPv6 address in brackets). Throws UsageError for anything else.
ListenAddress parse_listen_address(const std::string& text);

/// Returns whether the address is reachable from this machine only. Throws UsageError if it is not an IP
/// address.
bool is_loopback_address(const ListenAddress& listen);

}  // namespace kinloop
