#pragma once
// A client that sends exactly what a test wants, including what no browser would send.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace kinloop::test {

/// A part of the viewer's scene, or a piece of one: see viewer/scene/wire_format.hpp.
struct ReceivedPart {
  uint32_t kind = 0;
  uint32_t index = 0;
  double version = 0;
  double body_bytes = 0;    ///< of the whole part
  double offset_bytes = 0;  ///< of a piece
  std::string body;
};

class RawClient {
 public:
  /// Connects to a port on 127.0.0.1.
  explicit RawClient(int port);
  ~RawClient();
  RawClient(RawClient&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  /// Returns false if the other side has disconnected.
  bool send(const std::string& bytes);

  /// Reads until the other side closes, or nothing has come for some seconds.
  std::string read_all();

  /// Reads until `text` has come; false if the other side closes, or nothing comes for some seconds.
  bool receives(const std::string& text);

  /// Sends what the other side takes within a second; returns how much that was.
  size_t flood(const std::string& bytes);

  /// Sends a request for `target` and returns the whole response. `headers` are additional lines, each
  /// terminated by CRLF.
  std::string get(const std::string& target, const std::string& headers = "",
                  const std::string& host = "localhost");

  /// Requests a WebSocket; returns true if it was granted.
  bool open_feed(const std::string& target = "/feed", const std::string& headers = "");

  /// Returns the next message; nullopt if the other side closed.
  std::optional<ReceivedPart> next_piece();

  /// Returns the next part, or the rest of one, of which all pieces have come; nullopt if the other side
  /// closed.
  std::optional<ReceivedPart> next_part();

  /// Returns whether the other side closes within some seconds; messages are skipped.
  bool is_closed();

 private:
  bool read_exactly(size_t bytes, std::string& into);

  int socket_ = -1;
};

/// A frame as sent by a browser: final, text, masked.
std::string text_frame(const std::string& text);

/// The port in "http://host:port/...".
int port_of(const std::string& url);

}  // namespace kinloop::test
