#pragma once
// What there is to see, in parts that change one by one. Every change gives its part a new, higher version; a
// browser that has seen version v is up to date once it has got, in their order, the parts with higher ones.
//
// So one number per browser is all that is kept of it. One that is slow misses what was overtaken, never the
// last state; one that comes back says how far it was and gets the rest; and none can make the server hoard
// messages.

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "viewer/scene/wire_format.hpp"

namespace kinloop {

/// A part at one version.
struct ScenePart {
  PartKind kind = PartKind::kHello;
  uint32_t index = 0;
  uint64_t version = 0;
  std::shared_ptr<const Bytes> body;
};

class Scene {
 public:
  /// `run` names this scene among others: versions of different runs cannot be compared.
  explicit Scene(std::string run) : run_(std::move(run)) {}

  [[nodiscard]] const std::string& run() const { return run_; }

  /// Puts a part in place of what it was; nothing happens where it is the same.
  void put(PartKind kind, uint32_t index, Bytes body);

  /// The first part that changed after `version`; nothing when all is known.
  [[nodiscard]] std::optional<ScenePart> next_after(uint64_t version) const;

  /// What all parts take, bytes.
  [[nodiscard]] size_t bytes() const { return bytes_; }

 private:
  std::string run_;
  std::map<uint64_t, ScenePart> parts_;  // by version
  std::map<std::pair<PartKind, uint32_t>, uint64_t> version_of_;
  uint64_t newest_ = 0;
  size_t bytes_ = 0;
};

/// Puts those parts of a list of `count` entries that hold entries from `first` on; `encode(begin, end)`
/// gives the body of one.
template <class Encode>
void put_parts(Scene& scene, PartKind kind, size_t first, size_t count, const Encode& encode) {
  for (size_t part = first / kPartLength; part * kPartLength < count; ++part) {
    const size_t begin = part * kPartLength;
    scene.put(kind, static_cast<uint32_t>(part), encode(begin, std::min(count, begin + kPartLength)));
  }
}

}  // namespace kinloop
