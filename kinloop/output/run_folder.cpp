#include "kinloop/output/run_folder.hpp"

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/output_check.hpp"
#include "kinloop/base/text_file.hpp"
#include "kinloop/output/ply.hpp"

namespace kinloop {

RunFolder::RunFolder(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code error;
  for (const char* list : {"rgb.txt", "associations.txt"}) {
    if (!std::filesystem::exists(path_ / list, error)) continue;
    throw InputError(
        fmt::format("{}: holds a sequence ({}), some of whose files would be written over; choose "
                    "another folder with -o",
                    path_.string(), list));
  }
  require_writable_folder(path_);
}

RunFolder RunFolder::of_earlier_run(std::filesystem::path path) {
  RunFolder folder;
  folder.path_ = std::move(path);
  return folder;
}

void write_run_files(const RunFolder& folder, const RunFiles& files) {
  write_tum_trajectory(folder.trajectory(), files.trajectory);
  write_tum_trajectory(folder.keyframes(), files.keyframes);
  if (files.ground_truth.empty()) {
    std::error_code ignored;
    if (std::filesystem::exists(folder.figures(), ignored)) {  // else it is not an earlier run's
      std::filesystem::remove(folder.ground_truth(), ignored);
    }
  } else {
    write_tum_trajectory(folder.ground_truth(), files.ground_truth);
  }
  write_ply(folder.map(), files.map, files.frame);
  write_file(folder.figures(), files.figures.dump(2) + "\n");
}

nlohmann::json read_figures(const std::filesystem::path& path) {
  auto figures = nlohmann::json::parse(read_file(path), nullptr, false);
  if (!figures.is_object()) {
    throw InputError(fmt::format("{}: not a JSON object; run kinloop again to make it", path.string()));
  }
  return figures;
}

}  // namespace kinloop
