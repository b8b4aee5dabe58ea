#pragma once
// Recognises the content of a folder by its names.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace kinloop {

/// Sorted names of the files and folders in a folder; of a very large folder only some thousands, to which
/// `has_file` and `has_folder` are not limited.
class FolderContents {
 public:
  explicit FolderContents(const std::filesystem::path& folder);

  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }
  [[nodiscard]] const std::vector<std::string>& folders() const { return folders_; }
  [[nodiscard]] bool empty() const { return files_.empty() && folders_.empty(); }
  [[nodiscard]] bool has_file(std::string_view name) const;
  [[nodiscard]] bool has_folder(std::string_view name) const;

  /// Returns the first file with this prefix and suffix; empty if there is none.
  [[nodiscard]] std::string find_file(std::string_view beginning, std::string_view end) const;

  /// Returns the first colour image, see is_color_name; empty if there is none.
  [[nodiscard]] std::string first_image() const;

 private:
  std::filesystem::path folder_;
  std::vector<std::string> files_, folders_;
  bool complete_ = true;  ///< all names were read
};

/// Returns the folder with colour images: rgb, color or another of the usual names, in lower or upper case;
/// empty if there is none.
std::string color_folder(const FolderContents& contents);

/// Same for depth images.
std::string depth_folder(const FolderContents& contents);

/// Returns whether a file is a colour image (PNG, JPEG, PPM, PGM, BMP, TIFF, WebP) by the ending of its
/// name.
bool is_color_name(const std::filesystem::path& file);

/// Same for depth images (PNG, PGM, EXR, TIFF, NumPy, OpenCV's YAML, raw numbers).
bool is_depth_name(const std::filesystem::path& file);

/// Returns the last component of a path, also of "folder/" and ".".
std::string folder_name(const std::filesystem::path& folder);

/// Returns the name of another dataset's layout that kinloop cannot read, with the evidence: "KITTI
/// (image_2/)"; empty for any other.
std::string detect_dataset_layout(const std::filesystem::path& folder);

}  // namespace kinloop
