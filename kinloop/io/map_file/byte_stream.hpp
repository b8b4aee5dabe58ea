#pragma once
// Plain values as bytes, one after the other, and back.

#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace kinloop {

static_assert(std::endian::native == std::endian::little, "numbers are written as memory has them");

/// Appends `count` values.
template <class T>
void put_values(std::string& bytes, const T* values, size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

/// Appends a list with its length.
template <class T>
void put_list(std::string& bytes, const std::vector<T>& values) {
  const uint64_t count = values.size();
  put_values(bytes, &count, 1);
  put_values(bytes, values.data(), values.size());
}

/// Takes values off the front; once bytes are missing, nothing but zeros.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  T value() {
    T value{};
    copy(&value, 1);
    return value;
  }

  template <class T>
  std::vector<T> list() {
    const auto count = value<uint64_t>();
    if (count > rest_.size() / sizeof(T)) truncated_ = true;
    std::vector<T> values(truncated_ ? 0 : count);
    copy(values.data(), values.size());
    return values;
  }

  template <class T>
  void copy(T* values, size_t count) {
    truncated_ = truncated_ || count > rest_.size() / sizeof(T);
    if (truncated_ || count == 0) return;
    std::memcpy(static_cast<void*>(values), rest_.data(), count * sizeof(T));
    rest_.remove_prefix(count * sizeof(T));
  }

  /// Whether everything was there and nothing is left.
  [[nodiscard]] bool exhausted() const { return !truncated_ && rest_.empty(); }

 private:
  std::string_view rest_;
  bool truncated_ = false;
};

}  // namespace kinloop
