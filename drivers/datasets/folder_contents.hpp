#pragma once
// The names in a folder, to tell by what it holds.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace kinloop {

/// Names of the files and folders in a folder, sorted; of a very large folder, some thousands of them.
class FolderContents {
 public:
  explicit FolderContents(const std::filesystem::path& folder);

  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }
  [[nodiscard]] const std::vector<std::string>& folders() const { return folders_; }
  [[nodiscard]] bool empty() const { return files_.empty() && folders_.empty(); }
  [[nodiscard]] bool has_file(std::string_view name) const;
  [[nodiscard]] bool has_folder(std::string_view name) const;

  /// The first file with this beginning and end; empty where there is none.
  [[nodiscard]] std::string find_file(std::string_view beginning, std::string_view end) const;

  /// The first PNG or JPEG; empty where there is none.
  [[nodiscard]] std::string first_image() const;

 private:
  std::vector<std::string> files_, folders_;
};

/// What the layout of another data set is called and what tells it, "7-Scenes (frame-000000.color.png)";
/// empty for a folder in no layout known.
std::string detect_dataset_layout(const std::filesystem::path& folder);

}  // namespace kinloop
