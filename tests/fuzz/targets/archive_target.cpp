#include <filesystem>

#include "drivers/archives/unpack_archive.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace kinloop::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kLimit = 1 << 20;

/// Throws std::logic_error unless there are only files and folders, and no more than the limit.
void expect_harmless(const fs::path& folder) {
  uint64_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const auto status = entry.symlink_status();
    require(fs::is_regular_file(status) || fs::is_directory(status), "neither a file nor a folder");
    if (fs::is_regular_file(status)) bytes += entry.file_size();
  }
  require(bytes <= kLimit, "more than the limit");
}

}  // namespace

void read_archive_bytes(std::string_view bytes) {
  if (!archives_available()) return;
  with_file("a.zip", bytes, [](const fs::path& file) {
    const fs::path place = file.parent_path() / "place";
    accept([&] { unpack_archive(file, place / "in", {kLimit, "too much"}); });
    expect_harmless(place / "in");
    for (const fs::path& folder : {file.parent_path(), place}) {
      for (const auto& entry : fs::directory_iterator(folder))
        require(entry.path() == file || entry.path() == place || entry.path() == place / "in",
                "landed elsewhere");
    }
  });
}

}  // namespace kinloop::fuzz
