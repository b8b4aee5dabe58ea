#include "drivers/archives/unpack_archive.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/text/escaped.hpp"
#include "kinloop/core/text/lower_case.hpp"

#ifdef KINLOOP_WITH_ARCHIVES

#include <climits>
#include <clocale>
#include <memory>
#include <type_traits>

#include <archive.h>
#include <archive_entry.h>

#endif

namespace kinloop {

namespace fs = std::filesystem;

bool is_archive_name(const fs::path& file) {
  constexpr auto kEndings =
      std::to_array<std::string_view>({".zip", ".r3d", ".7z", ".tar", ".tar.gz", ".tgz", ".tar.bz2", ".tbz2",
                                       ".tar.xz", ".txz", ".tar.zst", ".tzst"});
  const std::string name = lower_case(file.filename().string());
  return std::any_of(kEndings.begin(), kEndings.end(), [&](std::string_view ending) {
    return name.size() > ending.size() && name.ends_with(ending);
  });
}

#ifdef KINLOOP_WITH_ARCHIVES

namespace {

using Reader = std::unique_ptr<archive, decltype(&archive_read_free)>;
using Writer = std::unique_ptr<archive, decltype(&archive_write_free)>;
using Locale = std::unique_ptr<std::remove_pointer_t<locale_t>, decltype(&freelocale)>;

/// Names in archives are UTF-8, which libarchive converts to the locale of the thread.
class Utf8Thread {
 public:
  Utf8Thread()
      : locale_(newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr), freelocale),
        before_(locale_ ? uselocale(locale_.get()) : nullptr) {}
  ~Utf8Thread() {
    if (locale_) uselocale(before_);
  }
  Utf8Thread(const Utf8Thread&) = delete;
  Utf8Thread& operator=(const Utf8Thread&) = delete;

 private:
  Locale locale_;
  locale_t before_;
};

std::string reason_of(archive* a) {
  const char* reason = archive_error_string(a);
  return reason != nullptr ? escaped(reason) : "no reason given";
}

/// Only formats and filters that libarchive has built in: for others it starts programs.
Reader open_reader(const fs::path& file) {
  constexpr size_t kBlockBytes = 1U << 16;
  Reader reader(require_memory(archive_read_new()), archive_read_free);
  archive* a = reader.get();
  for (const auto support :
       {archive_read_support_format_zip, archive_read_support_format_tar, archive_read_support_format_7zip,
        archive_read_support_filter_gzip, archive_read_support_filter_bzip2, archive_read_support_filter_xz,
        archive_read_support_filter_zstd})
    support(a);
  if (!fs::is_regular_file(file)) throw InputError(fmt::format("{}: not a regular file", file.string()));
  if (archive_read_open_filename(a, file.c_str(), kBlockBytes) != ARCHIVE_OK)
    throw InputError(
        fmt::format("{}: no archive that can be read ({}); delete it and copy or download it again",
                    file.string(), reason_of(a)));
  return reader;
}

/// Files and folders are made with usual permissions, and never through links.
Writer open_writer() {
  Writer writer(require_memory(archive_write_disk_new()), archive_write_free);
  archive_write_disk_set_options(
      writer.get(), ARCHIVE_EXTRACT_TIME | ARCHIVE_EXTRACT_SECURE_NODOTDOT | ARCHIVE_EXTRACT_SECURE_SYMLINKS);
  return writer;
}

/// One archive being unpacked.
class Unpacking {
 public:
  Unpacking(const fs::path& file, const fs::path& folder, const UnpackLimit& limit)
      : file_(file),
        folder_(fs::canonical(folder)),  // links on the way to it are the user's own
        limit_(limit),
        reader_(open_reader(file)),
        writer_(open_writer()),
        left_(limit.bytes) {}

  UnpackedFiles unpack_all() {
    while (archive_entry* entry = next_entry()) {
      if (!is_of_macos()) unpack(entry);
    }
    return written_;
  }

 private:
  /// Returns the next member, or null at the end.
  archive_entry* next_entry() {
    archive_entry* entry = nullptr;
    const int code = archive_read_next_header(reader_.get(), &entry);
    if (code == ARCHIVE_EOF) return nullptr;
    check_read(code, member_.empty() ? "damaged or truncated" : "damaged or truncated behind it");
    const char* name = archive_entry_pathname(entry);
    if (name == nullptr) fail("its name cannot be read");
    member_ = fs::path(name).relative_path();
    return entry;
  }

  void unpack(archive_entry* entry) {
    constexpr unsigned kFileMode = 0644, kFolderMode = 0755;
    const auto type = archive_entry_filetype(entry);
    if (archive_entry_hardlink(entry) != nullptr || (type != AE_IFREG && type != AE_IFDIR))
      fail("neither a file nor a folder, which a sequence never has");
    if (std::find(member_.begin(), member_.end(), "..") != member_.end())
      fail("leads out of the folder that it is unpacked in");
    const fs::path path = folder_ / member_;
    if (path.native().size() >= PATH_MAX) fail("its name is too long");
    const uint64_t stated = archive_entry_size_is_set(entry) != 0
                                ? static_cast<uint64_t>(std::max<la_int64_t>(0, archive_entry_size(entry)))
                                : 0;
    reserve(stated);
    archive_entry_set_pathname(entry, path.c_str());
    archive_entry_set_perm(entry, type == AE_IFREG ? kFileMode : kFolderMode);
    check_written(archive_write_header(writer_.get(), entry));
    if (type == AE_IFREG) copy_data(stated);
    check_written(archive_write_finish_entry(writer_.get()));
  }

  /// Copies the content of a file, which may be longer than stated.
  void copy_data(uint64_t stated) {
    const void* block = nullptr;
    size_t size = 0;
    la_int64_t offset = 0;
    uint64_t copied = 0;
    while (true) {
      const int code = archive_read_data_block(reader_.get(), &block, &size, &offset);
      if (code == ARCHIVE_EOF) break;
      check_read(code, "damaged or truncated");
      if (copied + size > stated) reserve(size);
      copied += size;
      check_written(archive_write_data_block(writer_.get(), block, size, offset));
    }
    ++written_.count;
    written_.bytes += copied;
  }

  /// Counts bytes, in whole blocks of the disk, against the limit.
  void reserve(uint64_t bytes) {
    constexpr uint64_t kBlock = 4096;
    const uint64_t blocks = bytes / kBlock + 1;
    if (blocks > left_ / kBlock) throw InputError(fmt::format("{}: {}", where(), limit_.exceeded));
    left_ -= blocks * kBlock;
  }

  /// Returns whether Finder has added the member to what the user packed.
  [[nodiscard]] bool is_of_macos() const {
    return (!member_.empty() && *member_.begin() == "__MACOSX") ||
           member_.filename().string().starts_with("._");
  }

  /// Checks libarchive's return code; a warning is not an error.
  void check_read(la_ssize_t code, const char* what) const {
    if (code < ARCHIVE_WARN) fail(fmt::format("{} ({})", what, reason_of(reader_.get())));
  }

  /// Same of what is written.
  void check_written(la_ssize_t code) const {
    if (code >= ARCHIVE_WARN) return;
    throw OutputError(
        fmt::format("{}: cannot be written ({}); free some space, or unpack it elsewhere and give the folder",
                    where(), reason_of(writer_.get())));
  }

  [[nodiscard]] std::string where() const {
    return member_.empty() ? file_.string()
                           : fmt::format("{}: {}", file_.string(), escaped(member_.string()));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format(
        "{}: {}; delete the archive and copy or download it again, or unpack it and give the folder", where(),
        what));
  }

  fs::path file_, folder_;
  const UnpackLimit& limit_;
  Reader reader_;
  Writer writer_;
  fs::path member_;  ///< the one being unpacked, or the last one that was
  uint64_t left_;    ///< bytes
  UnpackedFiles written_;
};

}  // namespace

bool archives_available() {
  return true;
}

UnpackedFiles unpack_archive(const fs::path& file, const fs::path& folder, const UnpackLimit& limit) {
  const Utf8Thread locale;
  fs::create_directories(folder);
  return Unpacking(file, folder, limit).unpack_all();
}

#else

bool archives_available() {
  return false;
}

UnpackedFiles unpack_archive(const fs::path& file, const fs::path&, const UnpackLimit&) {
  throw UsageError(fmt::format(
      "{}: this build does not unpack archives; unpack it and give the folder, or install libarchive-dev "
      "and build again",
      file.string()));
}

#endif

}  // namespace kinloop
