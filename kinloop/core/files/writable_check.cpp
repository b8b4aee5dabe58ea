#include "kinloop/core/files/writable_check.hpp"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/anonymous_temp_file.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {
namespace {

/// Returns the errno of a failed attempt to write a file in `folder`, or 0 on success. Writes data, since
/// some full disks still accept an empty file.
int try_to_write_in(const std::filesystem::path& folder) {
  constexpr char kContent[512] = {};
  const int descriptor = open_anonymous_temp_file(folder);
  if (descriptor < 0) return errno;
  const bool written = write(descriptor, kContent, sizeof kContent) == static_cast<ssize_t>(sizeof kContent);
  const int error = written ? 0 : errno;
  close(descriptor);
  return error;
}

}  // namespace

void require_writable_file(const std::filesystem::path& path) {
  if (path.empty()) return;
  const OutputPlace place = output_place(path);
  if (place.is_stream) return;
  const auto folder = place.target.parent_path();
  require_writable_folder(folder.empty() ? "." : folder);
}

void require_writable_folder(const std::filesystem::path& folder) {
  make_folder(folder);
  if (const int error = try_to_write_in(folder); error != 0) {
    throw InputError(fmt::format("{}: cannot write into this folder ({}); choose another output folder",
                                 folder.string(), std::generic_category().message(error)));
  }
}

}  // namespace kinloop
