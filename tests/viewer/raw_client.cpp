#include "tests/viewer/raw_client.hpp"

#include <cstring>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"

namespace kinloop::test {
namespace {

constexpr int kTimeoutS = 15;

}  // namespace

RawClient::RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  require(socket_ >= 0, "RawClient: a socket");
  const timeval timeout{kTimeoutS, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int result = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  require(result == 0, "RawClient: a connection");
}

RawClient::~RawClient() {
  if (socket_ >= 0) ::close(socket_);
}

bool RawClient::send(const std::string& bytes) {
  return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
}

size_t RawClient::flood(const std::string& bytes) {
  const timeval timeout{1, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &timeout, sizeof timeout);
  const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  return sent < 0 ? 0 : static_cast<size_t>(sent);
}

std::string RawClient::read_all() {
  std::string all;
  char buffer[65536];
  for (ssize_t n = 0; (n = ::recv(socket_, buffer, sizeof buffer, 0)) > 0;)
    all.append(buffer, static_cast<size_t>(n));
  return all;
}

bool RawClient::receives(const std::string& text) {
  std::string received;
  while (received.find(text) == std::string::npos) {
    if (!read_exactly(1, received)) return false;
  }
  return true;
}

std::string RawClient::get(const std::string& target, const std::string& headers, const std::string& host) {
  send("GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\n" + headers + "\r\n");
  return read_all();
}

bool RawClient::open_feed(const std::string& target, const std::string& headers) {
  send("GET " + target +
       " HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
       "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
       headers + "\r\n");
  std::string answer;
  while (!answer.ends_with("\r\n\r\n") && read_exactly(1, answer)) {
  }
  return answer.starts_with("HTTP/1.1 101");
}

bool RawClient::read_exactly(size_t bytes, std::string& into) {
  const size_t begin = into.size();
  into.resize(begin + bytes);
  for (size_t at = begin; at < into.size();) {
    const ssize_t n = ::recv(socket_, into.data() + at, into.size() - at, 0);
    if (n <= 0) return false;
    at += static_cast<size_t>(n);
  }
  return true;
}

std::optional<ReceivedPart> RawClient::next_part() {
  auto part = next_piece();
  while (part && part->offset_bytes + static_cast<double>(part->body.size()) < part->body_bytes) {
    const auto piece = next_piece();
    if (!piece) return std::nullopt;
    part->body += piece->body;
  }
  return part;
}

std::optional<ReceivedPart> RawClient::next_piece() {
  constexpr size_t kHeaderBytes = 32;
  constexpr int kBinary = 2, kPing = 9;
  while (true) {
    std::string head;
    if (!read_exactly(2, head)) return std::nullopt;
    uint64_t length = static_cast<uint8_t>(head[1]);
    const size_t more = length == 127 ? 8 : length == 126 ? 2 : 0;
    if (more > 0) {
      std::string digits;
      if (!read_exactly(more, digits)) return std::nullopt;
      length = 0;
      for (const char digit : digits) length = length << 8 | static_cast<uint8_t>(digit);
    }
    std::string message;
    if (!read_exactly(length, message)) return std::nullopt;
    const int opcode = head[0] & 15;
    if (opcode == kPing) continue;
    if (opcode != kBinary || message.size() < kHeaderBytes) return std::nullopt;
    ReceivedPart part;
    std::memcpy(&part.kind, message.data(), 4);
    std::memcpy(&part.index, message.data() + 4, 4);
    std::memcpy(&part.version, message.data() + 8, 8);
    std::memcpy(&part.body_bytes, message.data() + 16, 8);
    std::memcpy(&part.offset_bytes, message.data() + 24, 8);
    part.body = message.substr(kHeaderBytes);
    return part;
  }
}

bool RawClient::is_closed() {
  while (next_piece()) {
  }
  char byte = 0;
  return ::recv(socket_, &byte, 1, 0) <= 0;
}

std::string text_frame(const std::string& text) {
  constexpr char kFinalText = '\x81', kMasked = '\x80';
  const std::string mask = {0, 0, 0, 0};  // any mask is valid for the server
  return std::string{kFinalText} + static_cast<char>(kMasked | static_cast<char>(text.size())) + mask + text;
}

int port_of(const std::string& url) {
  return std::stoi(url.substr(url.find(':', url.find("//")) + 1));
}

}  // namespace kinloop::test
