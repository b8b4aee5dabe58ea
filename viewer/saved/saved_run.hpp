#pragma once
// Shows the results of a run, or any single cloud or mesh file.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "dense/mesh/colored_mesh.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "session/plan/viewer_options.hpp"
#include "tools/evaluation/evaluate.hpp"
#include "viewer/report/frame_table.hpp"
#include "viewer/saved/saved_loops.hpp"
#include "viewer/scene/scene.hpp"
#include "viewer/scene/wire_format.hpp"

namespace kinloop {

struct SavedRun {
  std::string name;
  ColoredCloud cloud;
  Trajectory path, keyframes, truth;  ///< each may be empty
  FrameTable frames;                  ///< empty if unknown
  std::vector<int64_t> doubt_ns;      ///< stamps of doubtful and lost frames, in order
  std::vector<SavedLoop> loops;       ///< accepted or not
  std::filesystem::path map_file;     ///< that holds the loops; empty if unknown
  nlohmann::json metrics;             ///< run.json
  Eigen::Vector3d up = {0, -1, 0};    ///< in the world frame

  Eigen::Vector2d half_size_at_1m = {0.6, 0.45};  ///< of the image

  // Content of a single file, or of mesh.ply or mesh.glb in the folder.
  ColoredMesh mesh;
  std::string model;     ///< bytes of a GLB file
  bool colored = true;   ///< whether the points have colours
  bool up_known = true;  ///< false: `up` is a guess
};

/// Returns the stamps of the doubtful and lost frames of a log.
std::vector<int64_t> doubt_of(std::span<const LoggedFrame> log);

/// Reads the folder of a run, in which only trajectory.txt is required, or a PLY, PCD or GLB file. Throws
/// InputError naming what is missing or damaged.
SavedRun read_saved_run(const std::filesystem::path& path);

/// Reads what a run's folder has beside poses: its frames, and the ground truth. Nothing of a map file.
SavedRun read_frames_and_truth(const std::filesystem::path& path);

/// Returns the frames of a run for its timeline, with those errors; without a frame table, those of the path.
std::vector<TimelineFrame> timeline_of(const SavedRun& run, std::span<const PoseError> errors = {});

/// What the page tells beside the figures.
struct Notice {
  std::string text;
  bool busy = false;  ///< a command of the page is being carried out
};

/// Fills the scene with what the first picture shows, of the cloud its first pieces, see split_into_pieces.
void show_first(Scene& scene, const SavedRun& run, std::span<const CloudPiece> pieces);

/// Returns the number of batches of the rest, which take long to encode.
size_t batch_count(std::span<const CloudPiece> pieces);

/// Encodes a batch of the rest. On any thread.
std::vector<EncodedPart> encode_batch(const SavedRun& run, std::span<const CloudPiece> pieces, size_t index);

/// Fills the scene with all of it.
void show_saved_run(Scene& scene, const SavedRun& run);

/// Shows a notice in a scene that shows the run.
void show_notice(Scene& scene, const SavedRun& run, const Notice& notice);

}  // namespace kinloop
