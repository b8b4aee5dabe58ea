#pragma once
// A stream of bytes from standard input, or from the program that connects to a Unix socket.

#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

#include "drivers/stream/socket_file.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

class ByteStream {
 public:
  explicit ByteStream(Descriptor descriptor) : descriptor_(std::move(descriptor)) {}

  /// Fills `buffer`, waiting for data; returns the number of bytes read, fewer at the end of the stream or if
  /// `stop` said so, which is asked ten times a second.
  size_t read(std::span<uint8_t> buffer, const StopRequest& stop) const;

 private:
  Descriptor descriptor_;
};

/// Standard input. Throws UsageError if it is a terminal.
ByteStream open_standard_input();

/// Creates a socket that only this user may connect to, waits for one connection and removes the socket.
/// Throws InputError if it cannot be created, as where another process listens, or if `stop` said so.
ByteStream accept_connection(const std::filesystem::path& path, const StopRequest& stop = {});

}  // namespace kinloop
