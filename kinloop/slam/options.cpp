#include "kinloop/slam/options.hpp"

namespace kinloop {

OptionHistory SlamOptions::history() {
  return {{{"self_calibration.depth_offset_sigma_per_m", "self_calibration.inverse_depth_bias_sigma_per_m"}},
          {"loop.consistent_keyframes"}};
}

TrackerOptions tracker_options(const SlamOptions& o) {
  return {o.features,
          o.tracking,
          o.local_map,
          o.min_initial_keypoints,
          o.lost_frames_before_new_component,
          o.max_predicted_sigma_m,
          o.localize_only,
          static_cast<uint64_t>(o.seed)};
}

MapperOptions mapper_options(const SlamOptions& o) {
  return {o.local_map, o.mapping};
}

PlaceOptions place_options(const SlamOptions& o) {
  return {o.tracking, o.local_map, o.loop, static_cast<uint64_t>(o.seed)};
}

BackEndOptions back_end_options(const SlamOptions& o) {
  return {o.executor,
          o.tracking,
          o.local_map,
          o.mapping,
          o.loop,
          o.global_ba,
          o.global_ba_enabled,
          o.global_ba_max_keyframes,
          o.self_calibration};
}

}  // namespace kinloop
