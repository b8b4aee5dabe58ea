#pragma once
// In: a Matroska file, via libavformat (optional dependency). Out: its tracks, attachments and blocks;
// nothing is decoded.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kinloop/core/files/byte_reader.hpp"

namespace kinloop {

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

}  // namespace kinloop
