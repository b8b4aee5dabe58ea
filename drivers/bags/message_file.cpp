#include "drivers/bags/message_file.hpp"

#include <fmt/format.h>

#include "drivers/bags/bag_files.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {

std::string ros1_type(std::string type) {
  constexpr std::string_view kRos2Part = "/msg";
  const size_t at = type.find("/msg/");
  if (at != std::string::npos) type.erase(at, kRos2Part.size());
  return type;
}

bool is_compressed_bag(const std::filesystem::path& path) {
  const auto inner = path.stem().extension();
  const bool compressed = path.extension() == ".zstd" || path.extension() == ".zst";
  return compressed && (inner == ".db3" || inner == ".mcap");
}

std::unique_ptr<MessageFile> open_message_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw InputError(fmt::format("{}: no such file; check the path", path.string()));
  if (std::filesystem::is_directory(path, ignored)) return open_ros2_folder(path);
  if (is_compressed_bag(path))
    throw InputError(
        fmt::format("{}: compressed as a whole; decompress it with `zstd -d` first", path.string()));
  if (path.extension() == ".mcap") return open_mcap(path);
  if (path.extension() == ".db3") return open_sqlite_bag(path);
  return open_ros1_bag(path);
}

}  // namespace kinloop
