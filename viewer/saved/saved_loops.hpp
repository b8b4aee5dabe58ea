#pragma once
// In: run.json, or a map. Out: the loops that a page lists, with what became of each and why.

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/core/ids.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// A loop as it stands at the end of a run.
struct SavedLoop {
  int64_t stamp_a_ns = 0, stamp_b_ns = 0;  ///< of its keyframes
  KeyframeId a, b;                         ///< indices into the shown keyframes; invalid: not among them
  int inliers = 0;                         ///< 0 if unknown
  int support = 0;                         ///< keyframes that measure the same relative pose; 0 if unknown
  std::optional<double> scale;             ///< of one visit relative to the other; nullopt if unknown
  LoopStage stage = LoopStage::kAccepted;
  LoopReason reason = LoopReason::kNone;  ///< none: unknown
};

/// Returns the `loops` and `other_loops` of run.json, without those that are damaged. Runs of earlier
/// versions list accepted ones only, without a status.
std::vector<SavedLoop> loops_of(const nlohmann::json& figures, const Trajectory& keyframes);

/// Returns the loops of a map whose keyframes are all shown.
std::vector<SavedLoop> loops_of(const Map& map);

/// Returns the pairs of shown keyframes that accepted loops join.
std::vector<std::pair<KeyframeId, KeyframeId>> accepted_pairs(std::span<const SavedLoop> loops);

/// Returns the list as the page reads it: stamps as text of seconds, null for what is unknown or not shown.
nlohmann::json to_json(std::span<const SavedLoop> loops);

}  // namespace kinloop
