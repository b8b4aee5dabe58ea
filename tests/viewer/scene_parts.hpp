#pragma once
// What a browser would receive of a scene.

#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "viewer/scene/scene.hpp"

namespace kinloop::test {

/// Returns the parts of a kind, the oldest first.
inline std::vector<ScenePart> parts(const Scene& scene, PartKind kind) {
  std::vector<ScenePart> found;
  for (auto next = scene.next_after(0); next; next = scene.next_after(next->version))
    if (next->kind == kind) found.push_back(*next);
  return found;
}

/// Returns the first of them; nullopt if there is none.
inline std::optional<ScenePart> part(const Scene& scene, PartKind kind) {
  const auto found = parts(scene, kind);
  return found.empty() ? std::nullopt : std::optional(found.front());
}

inline nlohmann::json json_of(const ScenePart& part) {
  return nlohmann::json::parse(part.body->begin(), part.body->end());
}

}  // namespace kinloop::test
