#pragma once
// In: a run, or a map file. Out: its map in a file, saved repeatedly; or an opened map with images, log and
// options.

#include <filesystem>

#include "dense/files/file_frame.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/slam/slam.hpp"
#include "session/plan/run_options.hpp"
#include "session/store/dense_recorder.hpp"

namespace kinloop {

/// Saves the map of a run periodically.
class MapSaver {
 public:
  struct Contents {
    const Slam& slam;
    DenseRecorder& recorder;
    const RunOptions& options;
    std::string input;
  };

  /// All of `contents` must outlive this object. `interval_s` 0: never during the run.
  MapSaver(std::filesystem::path path, const Contents& contents, double interval_s)
      : path_(std::move(path)), contents_(contents), interval_s_(interval_s) {}

  /// Throws InputError if the map cannot be written.
  void save();

  /// Same, but logs a failure and returns false, since it must not end the run.
  bool try_save();

  /// Saves if the interval has passed, but rarely enough to take only a small share of the time.
  void save_if_due();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Times of the latest save and of all saves.
  [[nodiscard]] const ElapsedTime& latest() const { return latest_; }
  [[nodiscard]] const ElapsedTime& total() const { return total_; }

 private:
  std::filesystem::path path_;
  Contents contents_;
  double interval_s_;
  ElapsedTime latest_;
  ElapsedTime total_;
  Stopwatch since_last_save_;
};

/// Returns the map file given by a file or by the folder of a run.
std::filesystem::path map_file_of(const std::filesystem::path& file_or_folder);

/// Reads the map and warns of damage.
SavedMap read_map_with_warnings(const MapReader& reader, const std::filesystem::path& path);

/// Reads the images and warns of damage; `shift` is added to the ids of their frames.
void load_images(const MapReader& reader, const std::filesystem::path& path, uint32_t shift,
                 DenseRecorder& recorder);

/// Sets the surfaces of the keyframes whose images are in the file, so that joins of maps can be judged as
/// those of visits in one run. They are those of the depth image, also of what moved: it was masked in the
/// run, and the file does not tell where.
void restore_surfaces(SavedMap& saved, const MapReader& reader);

/// Returns the options that the map at `path` was made with, if their key begins with `prefix`; else the
/// defaults. Throws InputError naming the file if it holds a value out of range.
RunOptions restore_options(const SavedMap& saved, const std::filesystem::path& path,
                           const std::string& prefix = {});

/// Returns a sentence that says with which camera the map in `path` was recorded; empty if it is `camera`.
std::string other_camera(const SavedMap& saved, const std::filesystem::path& path, const RgbdCamera& camera);

/// Throws InputError unless `camera` is the camera of the map in `path`.
void require_same_camera(const SavedMap& saved, const std::filesystem::path& path, const RgbdCamera& camera);

/// A map file to continue.
struct ContinuedMap {
  std::filesystem::path path;
  MapReader reader;
  SavedMap saved;

  /// Returns the default options but for the features, which are those of the map.
  [[nodiscard]] RunOptions options() const { return restore_options(saved, path, "features."); }

  /// Returns `camera` in the depth unit of the map's images. Throws InputError unless it is the map's.
  [[nodiscard]] RgbdCamera adapt(RgbdCamera camera) const;

  /// Restores the images in `recorder`; `shift` is added to the ids of their frames.
  void restore_images(uint32_t shift, DenseRecorder& recorder) const;
};

/// Opens a map file, or that of a run's folder, to continue it; nullopt for an empty path.
std::optional<ContinuedMap> open_continued_map(const std::filesystem::path& file_or_folder);

/// Throws InputError if a map has no images with known poses: a result made of them would be empty, and would
/// replace an earlier one.
void require_images(size_t count, const std::filesystem::path& map);

/// A map file opened for reading.
struct OpenMap {
  SavedMap saved;  ///< all but its map and frames
  RunOptions options;
  Map map;
  FrameLog log;
  DenseRecorder recorder;
  Trajectory poses;  ///< used instead of the map's poses; empty: the map's

  /// Returns the component of the map in which most frames of session `number` were tracked.
  [[nodiscard]] uint32_t component(size_t number) const;

  /// Returns its images with known poses; with `poses`, all that these cover.
  [[nodiscard]] std::vector<PosedImage> views(size_t number) const;

  /// Returns the camera that matches the poses.
  [[nodiscard]] DenseCamera dense_camera() const;

  /// Returns the readout time of the colour image.
  [[nodiscard]] double rolling_shutter_s() const;

  /// Estimates the up direction from these views.
  UpEstimate up(size_t number) { return recorder.up(views(number), dense_camera()); }

  /// Fuses the coloured cloud of these views.
  ColoredCloud cloud(size_t number, int threads, const Progress& progress);

  /// Returns the frames of session `number`, counted from 1; 0: of the last.
  [[nodiscard]] std::span<const LoggedFrame> session_log(size_t number) const;

  /// Returns the index into `saved.sessions`, which must not be empty, of session `number` as above. Throws
  /// UsageError if there is none.
  [[nodiscard]] size_t session_index(size_t number) const;
};

/// Returns the file frame selected by `--frame`: z-up, or camera. `views` are those of the map.
FileFrame file_frame(const std::string& name, const UpEstimate& up, std::span<const PosedImage> views);

/// The frame of a session's files, and its cloud.
struct FileCloud {
  FileFrame frame;
  ColoredCloud cloud;
};

struct FileCloudRequest {
  std::string frame;  ///< z-up or camera
  size_t session = 0;
  int threads = 1;
  bool with_cloud = true;  ///< else it stays empty
};

/// Returns those of the images that the map holds: called before `add_recorded_images`, those of --cloud.
FileCloud file_cloud(const FileCloudRequest& request, OpenMap& open, const Progress& progress);

/// Opens a map file, or that of a run's folder, with its images; `assignments` override its options, and
/// `poses`, unless empty, names a file of poses to use instead of the map's.
OpenMap open_map(const std::filesystem::path& file_or_folder, const std::vector<std::string>& assignments,
                 const std::filesystem::path& poses = {});

}  // namespace kinloop
