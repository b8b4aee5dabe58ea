#include "apps/common_options.hpp"

#include <cmath>

namespace kinloop {

void add_map_argument(CLI::App& command, std::filesystem::path& map) {
  command.add_option("MAP", map, "a map file, or the folder of a run")->required();
}

void add_poses_option(CLI::App& command, std::filesystem::path& poses) {
  command.add_option("--poses", poses,
                     "take the images' poses from this file (TUM format) instead of the map");
}

void add_set_option(CLI::App& command, std::vector<std::string>& assignments, const std::string& what) {
  command.add_option("--set", assignments, what + "; one each, to be repeated")
      ->allow_extra_args(false)
      ->option_text("KEY=VALUE");
}

void add_frame_option(CLI::App& command, std::string& frame) {
  command
      .add_option("--frame", frame,
                  "of the cloud or mesh: z-up, or camera, the first camera's (y down), which that of the\n"
                  "trajectory is")
      ->check(CLI::IsMember({"z-up", "camera"}))
      ->capture_default_str();
}

void add_threads_option(CLI::App& command, int& threads, const std::string& what) {
  command.add_option("--threads", threads, what)->check(CLI::Range(1, 1024));
}

CLI::Validator above_zero() {
  const auto check = [](const std::string& text) -> std::string {
    double value = 0;
    if (CLI::detail::lexical_cast(text, value) && value > 0 && std::isfinite(value)) return {};
    return "'" + text + "' must be a number above 0";
  };
  return {check, "POSITIVE"};
}

void add_quiet_option(CLI::App& command, bool& quiet) {
  command.add_flag("-q,--quiet", quiet, "print nothing but warnings and errors");
}

}  // namespace kinloop
