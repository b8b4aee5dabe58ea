#include "kinloop/core/files/output_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <string>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "kinloop-", kSuffix = ".tmp";

std::string text_of(int error) {
  return std::generic_category().message(error);
}

fs::path folder_of(const fs::path& file) {
  const fs::path folder = file.parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

/// Returns the descriptor that a link like /proc/self/fd/1 stands for.
std::optional<int> own_descriptor(const fs::path& link) {
  std::error_code error;
  const fs::path ours = fs::canonical("/proc/self/fd", error);
  if (error || fs::canonical(folder_of(link), error) != ours || error) return std::nullopt;
  const std::string name = link.filename().string();
  int descriptor = -1;
  const auto [end, failed] = std::from_chars(name.data(), name.data() + name.size(), descriptor);
  if (failed != std::errc() || end != name.data() + name.size()) return std::nullopt;
  return descriptor;
}

/// Follows links one by one, since the last may lead to a file that does not exist.
OutputPlace follow_links(const fs::path& path) {
  constexpr int kMostLinks = 40;  // as Linux
  OutputPlace place{path, false, std::nullopt};
  std::error_code error;
  for (int i = 0; fs::is_symlink(fs::symlink_status(place.target, error)); ++i) {
    if (i == kMostLinks)
      throw InputError(fmt::format("{}: too many symbolic links; give another name", path.string()));
    place.descriptor = own_descriptor(place.target);
    if (place.descriptor) return place;
    place.target = folder_of(place.target) / fs::read_symlink(place.target, error);
    if (error) break;
  }
  return place;
}

/// The mode to create a file with: what will replace an old file or go through a pipe is for this user alone,
/// until it gets the mode of the old one.
mode_t initial_mode(const OutputPlace& place) {
  constexpr mode_t kAll = 0666, kOwner = 0600;  // without the bits of umask
  std::error_code absent;
  return fs::exists(place.target, absent) || place.is_stream ? kOwner : kAll;
}

/// Creates a new file that no other process uses; returns its descriptor, or -1 with errno set.
int create_temporary(const fs::path& folder, mode_t mode, fs::path& path) {
  constexpr int kMostTries = 10000;
  for (int i = 0; i < kMostTries; ++i) {
    path = folder / fmt::format("{}{}-{}{}", kPrefix, getpid(), i, kSuffix);
    const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (descriptor < 0 && errno == EEXIST) continue;
    if (descriptor < 0) return -1;
    // Another process may have taken it for an abandoned one until the lock is held.
    const bool taken = flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    struct stat file {};
    if (!taken && fstat(descriptor, &file) == 0 && file.st_nlink > 0) return descriptor;
    close(descriptor);
  }
  errno = EEXIST;
  return -1;
}

/// Gives the new file the owner and the permissions of the old one, as far as this user may.
void copy_owner_and_mode(const fs::path& old_file, int descriptor) {
  constexpr mode_t kPermissions = 0777;
  struct stat old {};
  if (stat(old_file.c_str(), &old) != 0) return;
  if (fchown(descriptor, old.st_uid, old.st_gid) != 0)
    static_cast<void>(!fchown(descriptor, static_cast<uid_t>(-1), old.st_gid));
  fchmod(descriptor, old.st_mode & kPermissions);
}

/// Returns errno, or 0. Some file systems cannot flush.
int flush(int descriptor) {
  return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOSYS ? 0 : errno;
}

int open_folder(const fs::path& folder) {
  return open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

/// The new name of a file is on the disk when its folder is. Returns errno, or 0.
int flush_folder(const fs::path& folder) {
  const int descriptor = open_folder(folder);
  if (descriptor < 0) return 0;  // a folder may be writable but not readable
  const int error = flush(descriptor);
  close(descriptor);
  return error;
}

/// Returns errno, or 0.
int write_all(int descriptor, const char* bytes, size_t count) {
  while (count > 0) {
    const ssize_t written = write(descriptor, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes += written;
    count -= static_cast<size_t>(written);
  }
  return 0;
}

/// Returns errno, or 0.
int copy_all(int from, int to) {
  std::array<char, size_t{1} << 16> buffer;
  off_t at = 0;
  while (true) {
    const ssize_t count = pread(from, buffer.data(), buffer.size(), at);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    if (count == 0) return 0;
    if (const int error = write_all(to, buffer.data(), static_cast<size_t>(count)); error != 0) return error;
    at += count;
  }
}

/// Renames a file unless there is one of the new name. Returns errno, or 0.
int rename_to_free_name(const fs::path& from, const fs::path& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;  // else the file system does not know the flag
  std::error_code absent;
  if (fs::exists(fs::symlink_status(to, absent))) return EEXIST;
  return rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

/// Where a recording goes whose own name is not known or not free.
fs::path recovered_name(const fs::path& temporary) {
  const std::string name = temporary.filename().string();
  return temporary.parent_path() /
         ("recovered-" + name.substr(kPrefix.size(), name.size() - kPrefix.size() - kSuffix.size()) +
          ".mcap");
}

/// Whether the file begins like an MCAP file.
bool is_recording(int descriptor) {
  constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};
  std::array<char, kMcapMagic.size()> head{};
  return pread(descriptor, head.data(), head.size(), 0) == static_cast<ssize_t>(head.size()) &&
         std::string_view(head.data(), head.size()) == kMcapMagic;
}

void clear_abandoned(const fs::path& file, int descriptor) {
  if (!is_recording(descriptor)) {
    unlink(file.c_str());
    return;
  }
  const fs::path recovered = recovered_name(file);
  if (rename_to_free_name(file, recovered) != 0) return;
  log::warn("{}: recovered from a recording that was cut short", recovered.string());
}

}  // namespace

OutputPlace output_place(const fs::path& path) {
  OutputPlace place = follow_links(path);
  if (place.descriptor) {
    place.is_stream = true;
    return place;
  }
  std::error_code error;
  const auto status = fs::status(place.target, error);
  if (!path.has_filename() || fs::is_directory(status)) {
    throw InputError(fmt::format("{}: is a folder; give the name of a file in it", path.string()));
  }
  place.is_stream = fs::is_character_file(status) || fs::is_fifo(status);
  if (!place.is_stream && fs::exists(status) && !fs::is_regular_file(status)) {
    throw InputError(fmt::format("{}: is neither a file nor a pipe; give another name", path.string()));
  }
  if (fs::exists(status) && faccessat(AT_FDCWD, place.target.c_str(), W_OK, AT_EACCESS) != 0) {
    throw InputError(fmt::format("{}: may not be written ({}); change its permissions or give another name",
                                 path.string(), text_of(errno)));
  }
  return place;
}

bool is_standard_output(const fs::path& path) {
  return follow_links(path).descriptor == STDOUT_FILENO;
}

OutputFile::OutputFile(fs::path path, Durability durability)
    : path_(std::move(path)), place_(output_place(path_)), durability_(durability) {
  std::error_code error;
  const fs::path folder = place_.is_stream ? fs::temp_directory_path(error) : folder_of(place_.target);
  descriptor_ = create_temporary(folder, initial_mode(place_), temporary_);
  if (descriptor_ < 0) {
    throw OutputError(fmt::format("{}: cannot be written ({}); check that the folder exists and is writable",
                                  path_.string(), text_of(errno)));
  }
  if (!place_.is_stream) copy_owner_and_mode(place_.target, descriptor_);
}

OutputFile::~OutputFile() {
  if (!temporary_.empty()) unlink(temporary_.c_str());
  close(descriptor_);
}

void OutputFile::commit(Existing existing) {
  if (place_.is_stream) {
    copy_to_stream();
  } else {
    take_name(existing);
  }
}

void OutputFile::take_name(Existing existing) {
  const bool at_once = durability_ == Durability::kAtOnce;
  if (at_once) {
    if (const int error = flush(descriptor_); error != 0) fail(error);
  }
  const int error = existing == Existing::kKept ? rename_to_free_name(temporary_, place_.target)
                    : rename(temporary_.c_str(), place_.target.c_str()) == 0 ? 0
                                                                             : errno;
  if (error == EEXIST) {
    const std::string taken = path_.string();
    throw InputError(fmt::format("{}: another process has written it meanwhile; give another name", taken));
  }
  if (error != 0) fail(error);
  temporary_.clear();
  if (const int unflushed = at_once ? flush_folder(folder_of(place_.target)) : 0; unflushed != 0)
    fail(unflushed);
}

void OutputFile::copy_to_stream() const {
  const int stream = place_.descriptor ? fcntl(*place_.descriptor, F_DUPFD_CLOEXEC, 0)
                                       : open(place_.target.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (stream < 0) fail(errno);
  const int error = copy_all(descriptor_, stream);
  const bool closed = close(stream) == 0;
  if (error != 0 || !closed) fail(error != 0 ? error : errno);
}

void OutputFile::fail(int error) const {
  throw OutputError(
      fmt::format("{}: cannot be written ({}); is the disk full?", path_.string(), text_of(error)));
}

void OutputFile::keep_recording() noexcept {
  if (place_.is_stream) return;
  if (rename_to_free_name(temporary_, place_.target) != 0) {
    const fs::path recovered = recovered_name(temporary_);
    if (rename_to_free_name(temporary_, recovered) != 0) return;
    log::warn("{}: the recording is kept as {}", path_.string(), recovered.string());
  }
  temporary_.clear();
}

void clear_abandoned_files(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) continue;
    const int descriptor = open(entry.path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) continue;
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) clear_abandoned(entry.path(), descriptor);
    close(descriptor);
  }
}

void flush_files(const fs::path& folder) {
  const int descriptor = open_folder(folder);
  if (descriptor < 0) return;
  const int error = syncfs(descriptor) == 0 ? 0 : errno;
  close(descriptor);
  if (error != 0)
    throw OutputError(
        fmt::format("{}: writing failed ({}); is the disk full?", folder.string(), text_of(error)));
}

}  // namespace kinloop
