#include "tests/fuzz/targets/targets.hpp"

#include <algorithm>
#include <array>

#include "tests/fuzz/fuzz_target.hpp"

namespace kinloop::fuzz {
namespace {

constexpr auto kTargets = std::to_array<FuzzTarget>({
    {"archive", read_archive_bytes},
    {"azure", read_azure_bytes},
    {"azure_calibration", read_azure_calibration_bytes},
    {"camera", read_camera_bytes},
    {"dbow2", read_dbow2_bytes},
    {"depth_codec", read_depth_codec_bytes},
    {"depth_encodings", read_depth_encodings_bytes},
    {"descriptors", read_descriptors_bytes},
    {"frame_lists", read_frame_lists_bytes},
    {"g2o", read_g2o_bytes},
    {"glb", read_glb_bytes},
    {"http", read_http_bytes},
    {"jpeg", read_jpeg_bytes},
    {"layouts", read_layout_bytes},
    {"map", read_map_bytes},
    {"mcap", read_mcap_bytes},
    {"oni", read_oni_bytes},
    {"options", read_option_bytes},
    {"pcd", read_pcd_bytes},
    {"ply", read_ply_bytes},
    {"png", read_png_bytes},
    {"realsense_bag", read_ros1_bag_bytes},
    {"ros1_bag", read_ros1_bag_bytes},
    {"run_folder", read_run_folder_bytes},
    {"sens", read_sens_bytes},
    {"sqlite_bag", read_sqlite_bag_bytes},
    {"stream", read_stream_bytes},
    {"trajectory", read_trajectory_bytes},
    {"vocabulary", read_vocabulary_bytes},
    {"websocket", read_websocket_bytes},
});

}  // namespace

std::span<const FuzzTarget> fuzz_targets() {
  return kTargets;
}

const FuzzTarget* find_target(std::string_view name) {
  const auto found =
      std::find_if(kTargets.begin(), kTargets.end(), [&](const FuzzTarget& t) { return t.name == name; });
  return found == kTargets.end() ? nullptr : &*found;
}

}  // namespace kinloop::fuzz
