#include "viewer/scene/scene.hpp"

namespace kinloop {

void Scene::restart(std::string run) {
  run_ = std::move(run);
  parts_.clear();
  version_of_.clear();
  bytes_ = 0;
}

void Scene::put(PartKind kind, uint32_t index, WireBytes body) {
  auto [known, is_new] = version_of_.try_emplace({kind, index}, 0);
  if (!is_new) {
    const auto before = parts_.find(known->second);
    if (*before->second.body == body) return;
    bytes_ -= before->second.body->size();
    parts_.erase(before);
  }
  bytes_ += body.size();
  known->second = ++newest_;
  parts_[newest_] = {kind, index, newest_, std::make_shared<const WireBytes>(std::move(body))};
}

std::optional<ScenePart> Scene::next_after(uint64_t version) const {
  const auto next = parts_.upper_bound(version);
  if (next == parts_.end()) return std::nullopt;
  return next->second;
}

}  // namespace kinloop
