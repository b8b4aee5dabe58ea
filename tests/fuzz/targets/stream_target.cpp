#include <cstdio>

#include <unistd.h>

#include "drivers/stream/stream_source.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace kinloop::fuzz {

void read_stream_bytes(std::string_view bytes) {
  with_file("stream", bytes, [](const auto& path) {
    FILE* file = std::fopen(path.c_str(), "rb");
    ByteStream stream((Descriptor(::dup(fileno(file)))));
    std::fclose(file);
    accept([&] { read_frames(*open_stream(std::move(stream), "stream", {})); });
  });
}

}  // namespace kinloop::fuzz
