#include "apps/shared/files/download.hpp"

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_DOWNLOAD

#include <cstdio>
#include <memory>

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

}  // namespace kinloop

#endif
