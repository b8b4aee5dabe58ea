#pragma once
// In: a map with all that is needed to go on with it. Out: one file, and the map back from it. The format (an
// SQLite database with checksums, .kinmap) is described in docs/maps.md.
//
// A file that was damaged gives the sound part of its map: a keyframe that cannot be read takes its
// observations with it, a landmark or image only itself.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "kinloop/dense/image_store.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/io/map_file/checked_database.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// A frame of a run: where it was, relative to a keyframe.
struct SavedFrame {
  FrameId frame;
  int64_t stamp_ns = 0;
  int status = 0;  ///< a TrackStatus
  KeyframeId reference;
  SE3 T_reference_camera;
  KeyframeId keyframe;  ///< valid where the frame became one
  bool repeat = false;
};

/// A run that made the map, or went on with it.
struct SavedSession {
  std::string input;    ///< as the user wrote it
  FrameId first_frame;  ///< its frames are those from here to the next session
};

/// One number that was found of the sensor.
struct SavedParameter {
  double value = 0;
  double sigma = 0;
  bool used = false;
};

/// Everything of a map but its images.
struct SavedMap {
  std::string program;  ///< that wrote it
  std::vector<SavedSession> sessions;
  std::vector<std::pair<std::string, std::string>> options;  ///< of the latest run, key and value
  RgbdCamera camera;
  std::vector<SavedParameter> sensor;
  MapData map;
  std::vector<SavedFrame> frames;
};

/// The images of a frame.
struct SavedImages {
  FrameId frame;
  EncodedImages images;
};

/// Gives image `index`; called for each index in turn.
using ImageLoader = std::function<SavedImages(size_t index)>;

/// Writes the file, atomically. Depth images are in units of `map.camera.depth_scale`. Throws InputError.
void write_map(const std::filesystem::path& path, const SavedMap& map, size_t image_count,
               const ImageLoader& images);

/// What a file has lost.
struct MapDamage {
  size_t keyframes = 0, landmarks = 0, loop_edges = 0, frames = 0, images = 0;
  bool settings = false;  ///< options, sessions or what was found of the sensor

  [[nodiscard]] bool any() const {
    return keyframes + landmarks + loop_edges + frames + images > 0 || settings;
  }
};

/// What was lost, for people; empty where nothing was.
std::string describe(const MapDamage& damage);

/// Reads map files.
class MapReader {
 public:
  /// Throws InputError where the file is no map, or one of a newer format.
  explicit MapReader(std::filesystem::path path);

  /// The sound part of the map. Throws InputError where nothing of it is left.
  [[nodiscard]] std::pair<SavedMap, MapDamage> read() const;

  /// Calls `take` with the images in their order; says how many are lost.
  size_t read_images(const std::function<void(SavedImages)>& take) const;

 private:
  std::filesystem::path path_;
  DatabaseReader database_;
};

}  // namespace kinloop
