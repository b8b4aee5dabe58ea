#pragma once
// In: a map with everything needed to continue it. Out: one file, and the map read back. docs/maps.md
// describes the format (an SQLite database with checksums, .kinmap).
// From a damaged file the intact part of the map is read: an unreadable keyframe loses its observations, too;
// a landmark or image only itself.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "kinloop/io/map_file/checked_database.hpp"
#include "kinloop/map/saved_map.hpp"
#include "kinloop/sensor/images/encoded_images.hpp"

namespace kinloop {

/// The images of a frame.
struct SavedImages {
  FrameId frame;
  EncodedImages images;
};

/// Returns image `index`; called for each index in order.
using ImageLoader = std::function<SavedImages(size_t index)>;

/// Writes the file atomically. Depth images are in units of `map.camera.depth_scale`. Throws InputError.
void write_map(const std::filesystem::path& path, const SavedMap& map, size_t image_count,
               const ImageLoader& images);

/// The parts of a file that were lost.
struct MapDamage {
  size_t keyframes = 0, landmarks = 0, loops = 0, frames = 0, images = 0;
  bool settings = false;  ///< options, sessions or sensor parameters

  [[nodiscard]] bool any() const { return keyframes + landmarks + loops + frames + images > 0 || settings; }
};

/// Describes the damage for users; empty if there is none.
std::string describe(const MapDamage& damage);

/// Reads map files.
class MapReader {
 public:
  /// Throws InputError if the file is not a map or has a newer format.
  explicit MapReader(std::filesystem::path path);

  /// Reads the intact part of the map. Throws InputError if there is none.
  [[nodiscard]] std::pair<SavedMap, MapDamage> read() const;

  /// Calls `take` with the images in order; returns how many are lost.
  size_t read_images(const std::function<void(SavedImages)>& take) const;

 private:
  std::filesystem::path path_;
  DatabaseReader database_;
};

}  // namespace kinloop
