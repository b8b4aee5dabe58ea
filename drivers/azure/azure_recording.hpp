#pragma once
// The parts of a recording of the Azure Kinect SDK: its Matroska file, and the calibration that is attached
// to it.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {

// In: a Matroska file, via libavformat (optional dependency). Out: its tracks, attachments and blocks;
// nothing is decoded.

struct MatroskaTrack {
  std::string name;    ///< COLOR, DEPTH, ...
  std::string fourcc;  ///< MJPG, b16g, ..., or "png"
  int width = 0, height = 0;
  size_t frames = 0;  ///< from duration and rate, 0 if unknown
};

/// One image of a track; `data` is valid until the next one is read.
struct MatroskaBlock {
  size_t track = 0;
  int64_t stamp_ns = 0;
  Bytes data;
};

class MatroskaFile {
 public:
  /// Throws InputError if the file is not Matroska, and UsageError in a build without libavformat.
  explicit MatroskaFile(const std::filesystem::path& path);
  ~MatroskaFile();
  MatroskaFile(MatroskaFile&&) noexcept;

  [[nodiscard]] const std::vector<MatroskaTrack>& tracks() const;

  /// Returns the content of an attached file; nullopt if there is none of that name.
  [[nodiscard]] std::optional<std::string> attachment(const std::string& name) const;

  /// Returns the next block of a track; nullopt at the end, which is the last whole block of a truncated
  /// file.
  std::optional<MatroskaBlock> next();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

// In: calibration.json of an Azure Kinect or Femto recording. Out: its cameras in the modes of the recording.

struct AzureCalibration {
  PinholeCamera color, depth;
  SE3 T_color_depth;
};

/// Returns the factory calibration for images of these sizes; the sensor's mode follows from the size. Throws
/// InputError for anything that is not such a calibration, and for sizes that no mode has.
AzureCalibration read_azure_calibration(const std::string& json, cv::Size color, cv::Size depth);

}  // namespace kinloop
