#include <cmath>

#include "apps/run/summary/run_summary.hpp"
#include "kinloop/core/options.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

json loop_json(const LoopClosure& loop, const Map& map) {
  const RelativeScale& scale = loop.evidence.scale;
  return {{"stamp_a", format_stamp(map.keyframe(loop.a).stamp_ns)},
          {"stamp_b", format_stamp(map.keyframe(loop.b).stamp_ns)},
          {"inliers", loop.evidence.inliers},
          {"support", loop.support},
          {"scale", std::isfinite(scale.sigma) ? json(scale.factor) : json(nullptr)},
          {"status", name_of(loop.stage)},
          {"reason", name_of(loop.reason)}};
}

}  // namespace

json loops_json(const std::vector<LoopClosure>& loops, const Map& map) {
  json all = json::array();
  for (const LoopClosure& loop : loops) all.push_back(loop_json(loop, map));
  return all;
}

}  // namespace kinloop
