#include "viewer/saved/saved_loops.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/core/options.hpp"
#include "kinloop/core/time.hpp"
#include "viewer/index_by_stamp.hpp"

namespace kinloop {
namespace {

using nlohmann::json;
using IndexByStamp = decltype(index_by_stamp(Trajectory()));

std::optional<int64_t> stamp_of(const json& loop, const char* key) {
  if (!loop.contains(key) || !loop[key].is_string()) return std::nullopt;
  return parse_stamp_ns(loop[key].get<std::string>());
}

std::optional<double> number_of(const json& loop, const char* key) {
  if (!loop.contains(key) || !loop[key].is_number()) return std::nullopt;
  return loop[key].get<double>();
}

int count_of(const json& loop, const char* key) {
  constexpr double kMost = 1e9;
  return static_cast<int>(std::clamp(number_of(loop, key).value_or(0), 0.0, kMost));
}

template <NamedEnum Enum>
std::optional<Enum> named(const json& loop, const char* key) {
  if (!loop.contains(key) || !loop[key].is_string()) return std::nullopt;
  return value_named<Enum>(loop[key].get<std::string>());
}

KeyframeId keyframe_at(const IndexByStamp& keyframes, int64_t stamp_ns) {
  const auto found = keyframes.find(stamp_ns);
  return found == keyframes.end() ? KeyframeId{} : KeyframeId{found->second};
}

/// Whether a loop was decided on, or waited for a decision.
bool is_final(LoopStage stage) {
  return stage != LoopStage::kHypothesis && stage != LoopStage::kVerified;
}

/// nullopt if it is damaged, or is no loop yet.
std::optional<SavedLoop> read_loop(const json& listed, const IndexByStamp& keyframes) {
  const auto stamp_a_ns = stamp_of(listed, "stamp_a"), stamp_b_ns = stamp_of(listed, "stamp_b");
  const auto stage = listed.contains("status") ? named<LoopStage>(listed, "status") : LoopStage::kAccepted;
  if (!stamp_a_ns || !stamp_b_ns || !stage || !is_final(*stage)) return std::nullopt;
  return SavedLoop{.stamp_a_ns = *stamp_a_ns,
                   .stamp_b_ns = *stamp_b_ns,
                   .a = keyframe_at(keyframes, *stamp_a_ns),
                   .b = keyframe_at(keyframes, *stamp_b_ns),
                   .inliers = count_of(listed, "inliers"),
                   .support = count_of(listed, "support"),
                   .scale = number_of(listed, "scale"),
                   .stage = *stage,
                   .reason = named<LoopReason>(listed, "reason").value_or(LoopReason::kNone)};
}

SavedLoop saved_loop(const LoopClosure& loop, const Map& map) {
  const RelativeScale& scale = loop.evidence.scale;
  return {.stamp_a_ns = map.keyframe(loop.a).stamp_ns,
          .stamp_b_ns = map.keyframe(loop.b).stamp_ns,
          .a = loop.a,
          .b = loop.b,
          .inliers = loop.evidence.inliers,
          .support = loop.support,
          .scale = std::isfinite(scale.sigma) ? std::optional(scale.factor) : std::nullopt,
          .stage = loop.stage,
          .reason = loop.reason};
}

json index_json(KeyframeId keyframe) {
  return keyframe.valid() ? json(keyframe.value) : json(nullptr);
}

}  // namespace

std::vector<SavedLoop> loops_of(const json& figures, const Trajectory& keyframes) {
  const IndexByStamp index = index_by_stamp(keyframes);
  std::vector<SavedLoop> loops;
  for (const char* key : {"loops", "other_loops"}) {
    if (!figures.contains(key) || !figures[key].is_array()) continue;
    for (const json& listed : figures[key])
      if (auto loop = read_loop(listed, index)) loops.push_back(*loop);
  }
  return loops;
}

std::vector<SavedLoop> loops_of(const Map& map) {
  std::vector<SavedLoop> loops;
  for (const auto* list : {&map.loop_closures(), &map.other_loops()}) {
    for (const LoopClosure& loop : *list)
      if (is_final(loop.stage)) loops.push_back(saved_loop(loop, map));
  }
  return loops;
}

std::vector<std::pair<KeyframeId, KeyframeId>> accepted_pairs(std::span<const SavedLoop> loops) {
  std::vector<std::pair<KeyframeId, KeyframeId>> pairs;
  for (const SavedLoop& loop : loops) {
    if (loop.stage == LoopStage::kAccepted && loop.a.valid() && loop.b.valid())
      pairs.emplace_back(loop.a, loop.b);
  }
  return pairs;
}

json to_json(std::span<const SavedLoop> loops) {
  json list = json::array();
  for (const SavedLoop& loop : loops) {
    list.push_back({{"stampA", format_stamp(loop.stamp_a_ns)},
                    {"stampB", format_stamp(loop.stamp_b_ns)},
                    {"a", index_json(loop.a)},
                    {"b", index_json(loop.b)},
                    {"inliers", loop.inliers},
                    {"support", loop.support},
                    {"scale", loop.scale ? json(*loop.scale) : json(nullptr)},
                    {"status", name_of(loop.stage)},
                    {"reason", name_of(loop.reason)}});
  }
  return list;
}

}  // namespace kinloop
