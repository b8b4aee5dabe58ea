#pragma once
// The functions of the targets, each in the file of its reader. To add one: write its file, list it in
// targets.cpp and put a seed into corpus/<name>/.

#include <string_view>

namespace kinloop::fuzz {

void read_archive_bytes(std::string_view bytes);
void read_azure_bytes(std::string_view bytes);
void read_azure_calibration_bytes(std::string_view bytes);
void read_camera_bytes(std::string_view bytes);
void read_dbow2_bytes(std::string_view bytes);
void read_depth_codec_bytes(std::string_view bytes);
void read_depth_encodings_bytes(std::string_view bytes);
void read_descriptors_bytes(std::string_view bytes);
void read_frame_lists_bytes(std::string_view bytes);
void read_g2o_bytes(std::string_view bytes);
void read_glb_bytes(std::string_view bytes);
void read_http_bytes(std::string_view bytes);
void read_jpeg_bytes(std::string_view bytes);
void read_layout_bytes(std::string_view bytes);
void read_map_bytes(std::string_view bytes);
void read_mcap_bytes(std::string_view bytes);
void read_oni_bytes(std::string_view bytes);
void read_option_bytes(std::string_view bytes);
void read_pcd_bytes(std::string_view bytes);
void read_ply_bytes(std::string_view bytes);
void read_png_bytes(std::string_view bytes);
void read_ros1_bag_bytes(std::string_view bytes);
void read_run_folder_bytes(std::string_view bytes);
void read_sens_bytes(std::string_view bytes);
void read_sqlite_bag_bytes(std::string_view bytes);
void read_stream_bytes(std::string_view bytes);
void read_trajectory_bytes(std::string_view bytes);
void read_vocabulary_bytes(std::string_view bytes);
void read_websocket_bytes(std::string_view bytes);

}  // namespace kinloop::fuzz
