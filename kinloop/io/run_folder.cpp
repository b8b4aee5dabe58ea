#include "kinloop/io/run_folder.hpp"

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/text/json.hpp"

namespace kinloop {

RunFolder::RunFolder(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code error;
  for (const char* list : {"rgb.txt", "associations.txt"}) {
    if (!std::filesystem::exists(path_ / list, error)) continue;
    throw InputError(
        fmt::format("{}: holds a sequence ({}), which would be partly overwritten; choose "
                    "another folder with -o",
                    path_.string(), list));
  }
  require_writable_folder(path_);
  lock_ = std::make_shared<const FolderLock>(path_);
  remove_leftovers();
}

void RunFolder::remove_leftovers() const {
  clear_abandoned_files(loop_images());
  // Version 0.1 wrote NAME.tmp.
  for (const std::string& name : run_file_names()) {
    std::error_code ignored;
    const std::filesystem::path leftover = path_ / (name + ".tmp");
    if (std::filesystem::is_regular_file(leftover, ignored)) std::filesystem::remove(leftover, ignored);
  }
}

RunFolder RunFolder::open_existing(std::filesystem::path path) {
  RunFolder folder;
  folder.path_ = std::move(path);
  return folder;
}

std::vector<std::string> run_file_names() {
  const RunFolder folder = RunFolder::open_existing({});
  std::vector<std::string> names;
  for (const auto& file :
       {folder.trajectory(), folder.live(), folder.covariances(), folder.keyframes(), folder.ground_truth(),
        folder.frames(), folder.map(), folder.map_file(), folder.camera(), folder.mask(), folder.graph(),
        folder.run_json(), folder.report()})
    names.push_back(file.string());
  return names;
}

nlohmann::json read_run_json(const std::filesystem::path& path) {
  auto metrics = parse_json(read_file(path));
  if (!metrics.is_object()) {
    throw InputError(fmt::format("{}: not a JSON object; run kinloop again", path.string()));
  }
  // Version 0.1 called the timings "rooms".
  if (metrics.contains("rooms") && !metrics.contains("timings")) metrics["timings"] = metrics["rooms"];
  return metrics;
}

}  // namespace kinloop
