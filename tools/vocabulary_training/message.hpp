#pragma once
// Serialisation of numbers into messages, read back in the same order.

#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "kinloop/core/errors.hpp"
#include "tools/vocabulary_training/communicator.hpp"

namespace kinloop {

/// Appends the bytes of `values`.
template <class T>
void put(Message& message, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* bytes = reinterpret_cast<const uint8_t*>(values.data());
  message.insert(message.end(), bytes, bytes + values.size_bytes());
}

/// Appends the bytes of one value.
template <class T>
void put(Message& message, const T& value) {
  put(message, std::span<const T>(&value, 1));
}

/// Reads a message from the beginning.
class MessageReader {
 public:
  explicit MessageReader(const Message& message) : left_(message) {}

  template <class T>
  std::vector<T> read(size_t count) {
    require(count * sizeof(T) <= left_.size(), "MessageReader: read past the end of the message");
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), left_.data(), count * sizeof(T));
    left_ = left_.subspan(count * sizeof(T));
    return values;
  }

  template <class T>
  T read() {
    return read<T>(1).front();
  }

 private:
  std::span<const uint8_t> left_;
};

}  // namespace kinloop
