#pragma once
// The output folder of a run: files under fixed names, each written atomically.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/core/files/folder_lock.hpp"

namespace kinloop {

/// Name of the map file in a run folder.
constexpr const char* kMapFileName = "map.kinmap";

/// Returns the names of the files that a run writes into its folder.
std::vector<std::string> run_file_names();

/// A writable folder and the file names in it, which scripts rely on.
class RunFolder {
 public:
  /// Creates the folder if missing and checks that it is writable, so that a run does not fail at its end.
  /// Refuses a folder that holds a sequence, whose camera.yaml and groundtruth.txt would be overwritten, and
  /// one that another run writes into. Removes temporary files of killed runs. Throws InputError naming the
  /// folder and the remedy.
  explicit RunFolder(std::filesystem::path path);

  /// Opens the folder of an earlier run read-only; it may be on a read-only disk.
  static RunFolder open_existing(std::filesystem::path path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path trajectory() const { return path_ / "trajectory.txt"; }
  [[nodiscard]] std::filesystem::path live() const { return path_ / "live.txt"; }
  [[nodiscard]] std::filesystem::path covariances() const { return path_ / "covariances.txt"; }
  [[nodiscard]] std::filesystem::path keyframes() const { return path_ / "keyframes.txt"; }
  [[nodiscard]] std::filesystem::path ground_truth() const { return path_ / "groundtruth.txt"; }
  [[nodiscard]] std::filesystem::path frames() const { return path_ / "frames.txt"; }
  [[nodiscard]] std::filesystem::path loop_images() const { return path_ / "loops"; }
  [[nodiscard]] std::filesystem::path map() const { return path_ / "map.ply"; }
  [[nodiscard]] std::filesystem::path map_file() const { return path_ / kMapFileName; }
  [[nodiscard]] std::filesystem::path camera() const { return path_ / "camera.yaml"; }
  [[nodiscard]] std::filesystem::path mask() const { return path_ / "mask.png"; }
  [[nodiscard]] std::filesystem::path graph() const { return path_ / "graph.g2o"; }
  [[nodiscard]] std::filesystem::path run_json() const { return path_ / "run.json"; }
  [[nodiscard]] std::filesystem::path report() const { return path_ / "report.html"; }

 private:
  RunFolder() = default;
  void remove_leftovers() const;

  std::filesystem::path path_;
  std::shared_ptr<const FolderLock> lock_;  ///< null for the folder of an earlier run
};

/// Reads a run.json. Throws InputError naming the file if it is not a JSON object.
nlohmann::json read_run_json(const std::filesystem::path& path);

}  // namespace kinloop
