#include "viewer/server/access.hpp"

#include <algorithm>
#include <charconv>
#include <random>

#include <boost/asio/ip/address.hpp>
#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// Comparison in constant time, which prevents timing attacks.
bool constant_time_equal(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  }
  return difference == 0;
}

/// "localhost:8080" -> "localhost", "[::1]:8080" -> "[::1]".
std::string_view without_port(std::string_view host) {
  const size_t colon = host.rfind(':');
  const size_t bracket = host.rfind(']');
  const bool has_port =
      colon != std::string_view::npos && (bracket == std::string_view::npos || bracket < colon);
  return has_port ? host.substr(0, colon) : host;
}

bool is_loopback_host(std::string_view host) {
  std::string_view name = without_port(host);
  if (name == "localhost" || name == "[::1]") return true;
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address_v4(std::string(name), error);
  return !error && address.is_loopback();
}

bool is_same_origin(std::string_view origin, std::string_view host) {
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && origin.substr(kScheme.size()) == host;
}

boost::asio::ip::address parse_ip(const std::string& text) {
  boost::system::error_code error;
  auto address = boost::asio::ip::make_address(text, error);
  if (error) throw UsageError(fmt::format("'{}' is not an IP address, such as 127.0.0.1 or 0.0.0.0", text));
  return address;
}

}  // namespace

bool may_view(const RequestIdentity& identity, const AccessPolicy& rules) {
  if (rules.loopback_only && !is_loopback_host(identity.host)) return false;
  if (identity.origin && !is_same_origin(*identity.origin, identity.host)) return false;
  return rules.loopback_only || constant_time_equal(identity.token, rules.token);
}

bool may_control(const RequestIdentity& identity, const AccessPolicy& rules) {
  return may_view(identity, rules) && constant_time_equal(identity.token, rules.token);
}

std::string_view RequestTarget::value(std::string_view name) const {
  const auto found = query.find(name);
  return found == query.end() ? std::string_view() : found->second;
}

RequestTarget parse_target(std::string_view target) {
  const size_t mark = target.find('?');
  RequestTarget parsed{target.substr(0, mark), {}};
  std::string_view rest = mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
    const size_t equals = pair.find('=');
    if (equals != std::string_view::npos) parsed.query[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return parsed;
}

std::string random_token() {
  constexpr int kWords = 4;
  std::random_device device;
  std::string token;
  for (int i = 0; i < kWords; ++i) token += fmt::format("{:08x}", device());
  return token;
}

ListenAddress parse_listen_address(const std::string& text) {
  ListenAddress listen;
  if (text.empty()) return listen;
  const size_t colon = text.rfind(':');
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), listen.port);
  if (error != std::errc() || end != port.data() + port.size()) {
    throw UsageError(
        fmt::format("--viewer {}: expected PORT or ADDRESS:PORT, a port from 0 (any) to 65535", text));
  }
  if (colon != std::string::npos) listen.address = text.substr(0, colon);
  if (listen.address == "localhost") listen.address = ListenAddress().address;
  if (listen.address.starts_with('[') && listen.address.ends_with(']')) {
    listen.address = listen.address.substr(1, listen.address.size() - 2);
  }
  parse_ip(listen.address);
  return listen;
}

bool is_loopback_address(const ListenAddress& listen) {
  return parse_ip(listen.address).is_loopback();
}

}  // namespace kinloop
