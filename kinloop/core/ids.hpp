#pragma once
// Typed ids. Objects in kinloop refer to each other by id, never by pointer; a KeyframeId cannot be passed
// where a LandmarkId is expected.

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

namespace kinloop {

/// A strongly typed index. A default-constructed id is invalid (`valid()` is false).
template <class Tag>
struct Id {
  static constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

  uint32_t value = kNone;

  auto operator<=>(const Id&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads <=>
  [[nodiscard]] bool valid() const { return value != kNone; }
};

using FrameId = Id<struct FrameTag>;
using KeyframeId = Id<struct KeyframeTag>;
using LandmarkId = Id<struct LandmarkTag>;
using WordId = Id<struct WordTag>;

}  // namespace kinloop

/// @cond
template <class Tag>
struct std::hash<kinloop::Id<Tag>> {
  size_t operator()(const kinloop::Id<Tag>& id) const noexcept { return std::hash<uint32_t>{}(id.value); }
};
/// @endcond
