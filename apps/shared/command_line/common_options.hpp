#pragma once
// Options that several commands share, worded and bounded once.

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "session/source/open_frame_source.hpp"

namespace kinloop {

/// MAP: a map file, or the folder of a run that left one.
void add_map_argument(CLI::App& command, std::filesystem::path& map);

/// --poses FILE: poses to be taken instead of those of a map.
void add_poses_option(CLI::App& command, std::filesystem::path& poses);

/// --set KEY=VALUE, as often as one likes; `what` says of which options.
void add_set_option(CLI::App& command, std::vector<std::string>& assignments,
                    const std::string& what = "set an option, key=value; see kinloop run --options");

/// --frame z-up|camera of the clouds and meshes that are written.
void add_frame_option(CLI::App& command, std::string& frame);

/// --up x,y,z: adds the up direction to the assignments of options.
void add_up_option(CLI::App& command, std::vector<std::string>& assignments);

/// --camera FILE, --intrinsics fx,fy,cx,cy, --depth-scale UNITS_PER_M and --sensor NAME of a source.
void add_camera_options(CLI::App& command, CameraOptions& camera);

/// --sequence NAME: which of the sequences in a folder.
void add_sequence_option(CLI::App& command, std::string& chosen);

/// --threads N.
void add_threads_option(CLI::App& command, int& threads, const std::string& what = "number of threads");

/// For ->check: takes finite numbers above 0; CLI11's own names its bounds with all their 309 digits.
CLI::Validator positive_number();

/// For ->check: takes whole numbers from `low` to `high`.
CLI::Validator whole_number(int low, int high);

/// For ->check: takes numbers from `low` to `high`.
CLI::Validator number(double low, double high);

/// For ->check: takes one of the words.
CLI::Validator one_of(std::vector<std::string> words);

/// -q, --quiet.
void add_quiet_option(CLI::App& command, bool& quiet);

}  // namespace kinloop
