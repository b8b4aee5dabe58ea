#include "apps/shared/files/download.hpp"

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_DOWNLOAD

#include <cstdio>
#include <memory>

#include <archive.h>
#include <archive_entry.h>
#include <curl/curl.h>
#include <unistd.h>

namespace kinloop {
namespace {

/// A file being appended to.
struct Part {
  std::FILE* file = nullptr;
  curl_off_t begin = 0;  ///< bytes already present
  const Progress* progress = nullptr;

  explicit Part(const std::filesystem::path& path) : file(std::fopen(path.c_str(), "ab")) {
    if (file == nullptr)
      throw InputError(fmt::format("cannot write {}; choose another folder", path.string()));
    begin = static_cast<curl_off_t>(std::filesystem::file_size(path));
  }
  ~Part() { close(); }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

  /// Returns whether everything reached the disk.
  bool close() {
    if (file == nullptr) return true;
    const bool flushed = std::fflush(file) == 0 && fsync(fileno(file)) == 0;
    const bool closed = std::fclose(file) == 0;
    file = nullptr;
    return flushed && closed;
  }
};

size_t take(char* data, size_t size, size_t count, void* part) {
  return std::fwrite(data, size, count, static_cast<Part*>(part)->file) * size;
}

int show(void* user, curl_off_t total, curl_off_t now, curl_off_t, curl_off_t) {
  const auto* part = static_cast<const Part*>(user);
  if (total > 0 && part->progress != nullptr) {
    report(*part->progress, "downloading", static_cast<size_t>(part->begin + now),
           static_cast<size_t>(part->begin + total));
  }
  return 0;
}

using Curl = std::unique_ptr<CURL, decltype(&curl_easy_cleanup)>;

/// Only HTTPS, also after redirections, unless the user's own URL is HTTP.
void restrict_protocols(CURL* curl, bool plain) {
#if LIBCURL_VERSION_NUM >= 0x075500
  const char* protocols = plain ? "http,https" : "https";
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, protocols);
  curl_easy_setopt(curl, CURLOPT_REDIR_PROTOCOLS_STR, protocols);
#else
  const long protocols = plain ? CURLPROTO_HTTP | CURLPROTO_HTTPS : CURLPROTO_HTTPS;
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS, protocols);
  curl_easy_setopt(curl, CURLOPT_REDIR_PROTOCOLS, protocols);
#endif
}

/// A request that gives up when the server is silent, and never leaves HTTPS.
Curl make_request(const std::string& url) {
  constexpr long kStalledBytes = 1, kStalledSeconds = 60, kRedirects = 5, kConnectSeconds = 20;
  Curl curl(require_memory(curl_easy_init()), curl_easy_cleanup);
  curl_easy_setopt(curl.get(), CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl.get(), CURLOPT_FOLLOWLOCATION, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_MAXREDIRS, kRedirects);
  restrict_protocols(curl.get(), url.starts_with("http:"));
  curl_easy_setopt(curl.get(), CURLOPT_FAILONERROR, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
  curl_easy_setopt(curl.get(), CURLOPT_LOW_SPEED_LIMIT, kStalledBytes);
  curl_easy_setopt(curl.get(), CURLOPT_LOW_SPEED_TIME, kStalledSeconds);
  return curl;
}

Curl make_download(const std::string& url, Part& part) {
  Curl curl = make_request(url);
  curl_easy_setopt(curl.get(), CURLOPT_RESUME_FROM_LARGE, part.begin);
  curl_easy_setopt(curl.get(), CURLOPT_WRITEFUNCTION, take);
  curl_easy_setopt(curl.get(), CURLOPT_WRITEDATA, &part);
  curl_easy_setopt(curl.get(), CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(curl.get(), CURLOPT_XFERINFOFUNCTION, show);
  curl_easy_setopt(curl.get(), CURLOPT_XFERINFODATA, &part);
  return curl;
}

/// Size of the file by a HEAD request; -1 if the server does not report it.
curl_off_t size_at(const std::string& url) {
  const Curl curl = make_request(url);
  curl_easy_setopt(curl.get(), CURLOPT_NOBODY, 1L);
  const CURLcode code = curl_easy_perform(curl.get());
  if (code != CURLE_OK)
    throw InputError(fmt::format("{}: {}; try again later", url, curl_easy_strerror(code)));
  curl_off_t size = -1;
  curl_easy_getinfo(curl.get(), CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &size);
  return size;
}

using Reader = std::unique_ptr<archive, decltype(&archive_read_free)>;
using Writer = std::unique_ptr<archive, decltype(&archive_write_free)>;

/// Checks libarchive's return code; a warning is not an error.
void check_archive_result(int code, archive* a, const std::filesystem::path& file) {
  if (code >= ARCHIVE_WARN) return;
  const char* what = archive_error_string(a);
  throw InputError(fmt::format("cannot unpack {}: {}; delete it and fetch it again", file.string(),
                               what != nullptr ? what : "damaged"));
}

void require_room(const std::filesystem::path& file, la_int64_t bytes, uint64_t left) {
  if (bytes <= 0 || static_cast<uint64_t>(bytes) <= left) return;
  throw InputError(fmt::format("{}: unpacks to more than any sequence has; not unpacked", file.string()));
}

/// Copies the content of a file; counts its bytes against those that are `left`.
void copy_data(archive* from, archive* to, const std::filesystem::path& file, uint64_t& left) {
  const void* block = nullptr;
  size_t size = 0;
  la_int64_t offset = 0;
  while (true) {
    const int code = archive_read_data_block(from, &block, &size, &offset);
    if (code == ARCHIVE_EOF) return;
    check_archive_result(code, from, file);
    require_room(file, static_cast<la_int64_t>(size), left);
    left -= size;
    check_archive_result(static_cast<int>(archive_write_data_block(to, block, size, offset)), to, file);
  }
}

}  // namespace

bool download_available() {
  return true;
}

void download(const std::string& url, const std::filesystem::path& file, const Progress& progress) {
  const std::filesystem::path part_path = file.string() + ".part";
  const curl_off_t size = size_at(url);
  if (std::filesystem::exists(part_path) && size >= 0 &&
      static_cast<curl_off_t>(std::filesystem::file_size(part_path)) > size) {
    std::filesystem::remove(part_path);  // of another version of the file
  }
  {
    Part part(part_path);
    part.progress = &progress;
    if (size < 0 || part.begin < size) {
      const CURLcode code = curl_easy_perform(make_download(url, part).get());
      if (!part.close()) throw InputError(fmt::format("{}: the disk is full", part_path.string()));
      if (code != CURLE_OK) {
        throw InputError(
            fmt::format("{}: {}; run the same command again to resume", url, curl_easy_strerror(code)));
      }
    }
  }
  const auto there = static_cast<curl_off_t>(std::filesystem::file_size(part_path));
  if (size >= 0 && there != size) {
    throw InputError(
        fmt::format("{}: received {} of {} bytes; run the same command again to resume", url, there, size));
  }
  std::filesystem::rename(part_path, file);
}

void unpack(const std::filesystem::path& file, const std::filesystem::path& folder, uint64_t max_bytes) {
  constexpr size_t kBlockBytes = 1U << 16;
  constexpr int kFlags =
      ARCHIVE_EXTRACT_TIME | ARCHIVE_EXTRACT_SECURE_NODOTDOT | ARCHIVE_EXTRACT_SECURE_SYMLINKS;
  const Reader reader(require_memory(archive_read_new()), archive_read_free);
  const Writer writer(require_memory(archive_write_disk_new()), archive_write_free);
  archive_read_support_filter_all(reader.get());
  archive_read_support_format_all(reader.get());
  archive_write_disk_set_options(writer.get(), kFlags);
  check_archive_result(archive_read_open_filename(reader.get(), file.c_str(), kBlockBytes), reader.get(),
                       file);
  std::filesystem::create_directories(folder);
  const auto place = std::filesystem::canonical(folder);  // links on the way to it are the user's own
  archive_entry* entry = nullptr;
  while (true) {
    const int code = archive_read_next_header(reader.get(), &entry);
    if (code == ARCHIVE_EOF) return;
    check_archive_result(code, reader.get(), file);
    const std::filesystem::path name = std::filesystem::path(archive_entry_pathname(entry)).relative_path();
    archive_entry_set_pathname(entry, (place / name).c_str());
    const auto type = archive_entry_filetype(entry);
    if (archive_entry_hardlink(entry) != nullptr || (type != AE_IFREG && type != AE_IFDIR)) {
      throw InputError(fmt::format(
          "{}: contains {}, neither a file nor a folder, which a sequence never has; not unpacked",
          file.string(), name.string()));
    }
    require_room(file, archive_entry_size(entry), max_bytes);
    check_archive_result(archive_write_header(writer.get(), entry), writer.get(), file);
    copy_data(reader.get(), writer.get(), file, max_bytes);
    check_archive_result(archive_write_finish_entry(writer.get()), writer.get(), file);
  }
}

}  // namespace kinloop

#else

namespace kinloop {

bool download_available() {
  return false;
}

void download(const std::string& url, const std::filesystem::path&, const Progress&) {
  throw UsageError(fmt::format(
      "{}: this build cannot download; install libcurl4-openssl-dev and libarchive-dev and rebuild", url));
}

void unpack(const std::filesystem::path&, const std::filesystem::path&, uint64_t) {
  require(false, "unpack: not in this build");
}

}  // namespace kinloop

#endif
