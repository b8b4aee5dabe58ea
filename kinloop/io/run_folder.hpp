#pragma once
// What a run leaves behind: a folder of files under fixed names, each written completely or not at all.

#include <filesystem>

#include <nlohmann/json.hpp>

#include "kinloop/dense/cloud/colored_cloud.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/io/file_frame.hpp"

namespace kinloop {

/// The name of the map file in a run's folder.
constexpr const char* kMapFileName = "map.kinmap";

/// A folder that exists and can be written to, and the names in it, which scripts rely on.
class RunFolder {
 public:
  /// Makes the folder where it is missing and tries whether files can be written into it, so that a run does
  /// not find out at its end. A folder that holds a sequence is refused: its camera.yaml and groundtruth.txt
  /// would be written over. Throws InputError naming the folder and the remedy.
  explicit RunFolder(std::filesystem::path path);

  /// The folder of an earlier run, that is only read: it may be on a disk that cannot be written to.
  static RunFolder open_existing(std::filesystem::path path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path trajectory() const { return path_ / "trajectory.txt"; }
  [[nodiscard]] std::filesystem::path keyframes() const { return path_ / "keyframes.txt"; }
  [[nodiscard]] std::filesystem::path ground_truth() const { return path_ / "groundtruth.txt"; }
  [[nodiscard]] std::filesystem::path frames() const { return path_ / "frames.txt"; }
  [[nodiscard]] std::filesystem::path loop_images() const { return path_ / "loops"; }
  [[nodiscard]] std::filesystem::path map() const { return path_ / "map.ply"; }
  [[nodiscard]] std::filesystem::path map_file() const { return path_ / kMapFileName; }
  [[nodiscard]] std::filesystem::path camera() const { return path_ / "camera.yaml"; }
  [[nodiscard]] std::filesystem::path graph() const { return path_ / "graph.g2o"; }
  [[nodiscard]] std::filesystem::path run_json() const { return path_ / "run.json"; }
  [[nodiscard]] std::filesystem::path report() const { return path_ / "report.html"; }

 private:
  RunFolder() = default;

  std::filesystem::path path_;
};

/// A run's results, as values.
struct RunFiles {
  Trajectory trajectory;
  Trajectory keyframes;
  Trajectory ground_truth;  ///< empty where there is none; no file is written then, and an old one removed
  ColoredCloud map;         ///< in the world
  FileFrame frame;          ///< of map.ply
  nlohmann::json metrics;   ///< run.json
};

/// Writes all of them (camera.yaml, graph.g2o, frames.txt, loops and report.html are others' work).
void write_run_files(const RunFolder& folder, const RunFiles& files);

/// Reads a run.json. Throws InputError naming the file when it is not JSON with an object.
nlohmann::json read_run_json(const std::filesystem::path& path);

}  // namespace kinloop
