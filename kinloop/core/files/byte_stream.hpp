#pragma once
// Serialisation of plain values as consecutive bytes.

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

/// Appends a list preceded by its length.
template <class T>
void put_list(std::string& bytes, const std::vector<T>& values) {
  const uint64_t count = values.size();
  put_values(bytes, &count, 1);
  put_values(bytes, values.data(), values.size());
}

/// Reads values from the front; returns zeros once the bytes are exhausted.
class ValueReader {
 public:
  explicit ValueReader(std::string_view bytes) : rest_(bytes) {}

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

  /// Returns whether a value was missing.
  [[nodiscard]] bool truncated() const { return truncated_; }

  /// Returns whether all values were present and none is left.
  [[nodiscard]] bool exhausted() const { return !truncated_ && rest_.empty(); }

 private:
  std::string_view rest_;
  bool truncated_ = false;
};

}  // namespace kinloop
