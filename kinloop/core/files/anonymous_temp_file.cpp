#include "kinloop/core/files/anonymous_temp_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

constexpr size_t kSegmentBytes = size_t{16} << 20;
constexpr size_t kAlignment = 64;  // a cache line, and enough for every type

[[noreturn]] void fail() {
  const int reason = errno;
  require_temporary_folder();
  throw OutputError(fmt::format("{}: temporary file: {}; free some space, or set TMPDIR to another folder",
                                temporary_folder().string(), std::generic_category().message(reason)));
}

bool write_at(int file, std::span<const uint8_t> bytes, size_t offset) {
  while (!bytes.empty()) {
    const ssize_t written = pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(written));
    offset += static_cast<size_t>(written);
  }
  return true;
}

}  // namespace

std::filesystem::path temporary_folder() {
  std::error_code error;
  const auto folder = std::filesystem::temp_directory_path(error);
  return error ? std::filesystem::path("TMPDIR") : folder;
}

void require_temporary_folder() {
  const char* set = std::getenv("TMPDIR");
  const std::filesystem::path folder = set != nullptr && *set != 0 ? set : temporary_folder();
  std::error_code error;
  if (std::filesystem::is_directory(folder, error)) return;
  throw OutputError(fmt::format(
      "{}: no folder for temporary files; create it, or set TMPDIR to another folder", folder.string()));
}

int open_anonymous_temp_file(const std::filesystem::path& folder) {
  std::string name = (folder / "kinloop_XXXXXX").string();
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor >= 0) unlink(name.c_str());
  return descriptor;
}

/// A file of fixed size. Only bytes that were written are handed out, so reading them never meets a hole that
/// a full disk cannot fill (SIGBUS).
struct MappedTempFile::Segment {
  explicit Segment(size_t bytes) : size(bytes), file(open_anonymous_temp_file(temporary_folder())) {
    if (file < 0) fail();
    if (ftruncate(file, static_cast<off_t>(size)) == 0)
      address = mmap(nullptr, size, PROT_READ, MAP_SHARED, file, 0);
    if (address != MAP_FAILED) return;
    const int reason = errno;
    close_file();
    errno = reason;
    fail();
  }
  ~Segment() {
    munmap(address, size);
    close_file();
  }
  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;

  void close_file() {
    if (file >= 0) close(file);
    file = -1;
  }

  size_t size;
  int file;
  void* address = MAP_FAILED;
  size_t used = 0;
};

std::shared_ptr<const uint8_t> MappedTempFile::add(std::span<const uint8_t> bytes) {
  const size_t padded = (bytes.size() + kAlignment - 1) / kAlignment * kAlignment;
  if (segments_.empty() || segments_.back()->size - segments_.back()->used < padded) {
    auto next = std::make_shared<Segment>(std::max(kSegmentBytes, padded));
    if (!segments_.empty()) segments_.back()->close_file();  // its mapping stays
    segments_.push_back(std::move(next));
  }
  Segment& segment = *segments_.back();
  if (!write_at(segment.file, bytes, segment.used)) fail();
  const auto* place = static_cast<const uint8_t*>(segment.address) + segment.used;
  segment.used += padded;
  size_bytes_ += bytes.size();
  return {segments_.back(), place};
}

void MappedTempFile::drop_pages() const {
  for (const auto& segment : segments_) madvise(segment->address, segment->size, MADV_DONTNEED);
}

}  // namespace kinloop
