#pragma once
// The displayed scene as parts that change independently. Every change gives its part a new, higher version;
// a browser that has seen version v is up to date once it has received, in order, the parts with higher ones.
// So the server stores only one number per browser. A slow browser misses superseded states, never the last
// one; a browser that reconnects sends its version and receives the rest; and none can make the server
// accumulate messages.

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "viewer/scene/wire_format.hpp"

namespace kinloop {

/// A part at one version.
struct ScenePart {
  PartKind kind = PartKind::kHello;
  uint32_t index = 0;
  uint64_t version = 0;
  std::shared_ptr<const WireBytes> body;
};

/// A part that is encoded, but not in a scene yet.
struct EncodedPart {
  PartKind kind = PartKind::kHello;
  uint32_t index = 0;
  WireBytes body;
};

class Scene {
 public:
  /// `run` identifies this scene: versions of different runs are not comparable.
  explicit Scene(std::string run) : run_(std::move(run)) {}

  [[nodiscard]] const std::string& run() const { return run_; }

  /// Drops all parts: what follows is another scene, which browsers show instead of what they have. The hello
  /// with the new `run` must be put first.
  void restart(std::string run);

  /// Replaces a part; does nothing if it is unchanged.
  void put(PartKind kind, uint32_t index, WireBytes body);

  /// Replaces parts that were encoded before.
  void put(std::vector<EncodedPart> parts) {
    for (EncodedPart& part : parts) put(part.kind, part.index, std::move(part.body));
  }

  /// Returns the first part that changed after `version`; nullopt if up to date.
  [[nodiscard]] std::optional<ScenePart> next_after(uint64_t version) const;

  /// The version of the part that was put last.
  [[nodiscard]] uint64_t newest() const { return newest_; }

  /// Total size of all parts, bytes.
  [[nodiscard]] size_t bytes() const { return bytes_; }

 private:
  std::string run_;
  std::map<uint64_t, ScenePart> parts_;  // by version
  std::map<std::pair<PartKind, uint32_t>, uint64_t> version_of_;
  uint64_t newest_ = 0;
  size_t bytes_ = 0;
};

/// Updates the parts of a list of `count` entries that hold entries from `first` on; `encode(begin, end)`
/// returns the body of one.
template <class Encode>
void put_parts(Scene& scene, PartKind kind, size_t first, size_t count, const Encode& encode) {
  for (size_t part = first / kPartLength; part * kPartLength < count; ++part) {
    const size_t begin = part * kPartLength;
    scene.put(kind, static_cast<uint32_t>(part), encode(begin, std::min(count, begin + kPartLength)));
  }
}

}  // namespace kinloop
