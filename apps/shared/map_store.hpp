#pragma once
// The map files of runs: saved while a run goes on, opened again.

#include <filesystem>

#include "apps/run/run_options.hpp"
#include "kinloop/base/stopwatch.hpp"
#include "kinloop/io/file_frame.hpp"
#include "kinloop/slam/dense_recorder.hpp"
#include "kinloop/slam/slam.hpp"

namespace kinloop {

/// Saves the map of a run, now and then while it goes on.
class MapSaver {
 public:
  struct Contents {
    const Slam& slam;
    DenseRecorder& recorder;
    const RunOptions& options;
    std::string input;
  };

  /// All of `contents` must outlive this object. `interval_s` 0: never while the run goes on.
  MapSaver(std::filesystem::path path, const Contents& contents, double interval_s)
      : path_(std::move(path)), contents_(contents), interval_s_(interval_s) {}

  /// Throws InputError where the map cannot be written.
  void save();

  /// The same where a map that cannot be written must not cost the rest: says why, and gives false.
  bool try_save();

  /// Saves when the interval has passed, and so seldom that it takes a small share of the time.
  void save_if_due();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Of the latest save.
  [[nodiscard]] double seconds() const { return duration_s_; }

 private:
  std::filesystem::path path_;
  Contents contents_;
  double interval_s_;
  double duration_s_ = 0;
  Stopwatch since_last_save_;
};

/// The map file that a user means by a file, or by the folder of a run.
std::filesystem::path map_file_of(const std::filesystem::path& file_or_folder);

/// Reads the map, and warns of what is lost of it.
SavedMap read_map_with_warnings(const MapReader& reader, const std::filesystem::path& path);

/// Reads the images, and warns of what is lost of them; `shift` is added to the ids of their frames.
void restore_images(const MapReader& reader, const std::filesystem::path& path, uint32_t shift,
                    DenseRecorder& recorder);

/// `options` as a map was made with; only those whose key begins with `prefix`.
RunOptions restore_options(const SavedMap& saved, const RunOptions& options, const std::string& prefix = {});

/// Throws InputError unless frames of `camera` go with the map in `path`.
void require_same_camera(const SavedMap& saved, const std::filesystem::path& path, const RgbdCamera& camera);

/// Refuses to write over what is read. Throws UsageError naming `option`.
void require_different_file(const char* option, const std::filesystem::path& output,
                            const std::filesystem::path& input);

/// A map file, opened to be looked at.
struct OpenMap {
  SavedMap saved;  ///< but its map, frames
  RunOptions options;
  Map map;
  FrameLog log;
  DenseRecorder recorder;
  Trajectory poses;  ///< to be taken instead of the map's; empty: the map's

  /// The component of the map in which most frames of session `number` were tracked.
  [[nodiscard]] uint32_t component(size_t number) const;

  /// Its images whose place is known; with poses of one's own all that these place.
  [[nodiscard]] std::vector<PosedImage> views(size_t number) const;

  /// The camera as it goes with the poses.
  [[nodiscard]] DenseCamera dense_camera() const;

  /// Which way is up, by what these saw.
  UpEstimate up(size_t number) { return recorder.up(views(number), dense_camera()); }

  /// The coloured cloud of these.
  ColoredCloud cloud(size_t number, int threads, const Progress& progress);

  /// The frames of session `number`, counted from 1; 0: of the last.
  [[nodiscard]] std::span<const LoggedFrame> session_log(size_t number) const;
};

/// The frame of files that `--frame` names: z-up, or camera. `views` are those of the map.
FileFrame file_frame(const std::string& name, const UpEstimate& up, std::span<const PosedImage> views);

/// Opens a map file, or that of a run's folder, with its images; `assignments` change the options it was made
/// with, `poses` names a file of poses to be taken instead of the map's, where it is not empty.
OpenMap open_map(const std::filesystem::path& file_or_folder, const std::vector<std::string>& assignments,
                 const std::filesystem::path& poses = {});

}  // namespace kinloop
