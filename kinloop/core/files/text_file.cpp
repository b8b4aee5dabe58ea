#include "kinloop/core/files/text_file.hpp"

#include <charconv>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"

namespace kinloop {

void throw_no_access(const std::filesystem::path& path, const std::error_code& error) {
  const char* remedy = "check the path";
  if (error == std::errc::permission_denied) remedy = "check the permissions of the folders on its path";
  if (error == std::errc::filename_too_long) remedy = "use shorter names";
  throw InputError(fmt::format("{}: cannot be accessed ({}); {}", path.string(), error.message(), remedy));
}

void require_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) {
    if (error) throw_no_access(folder, error);
    throw InputError(fmt::format("{}: no such folder; check the path", folder.string()));
  }
  if (!std::filesystem::is_directory(folder, error)) {
    throw InputError(fmt::format("{}: not a folder; give the folder that holds the files", folder.string()));
  }
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw InputError(fmt::format("{}: cannot create the folder ({}); choose another output folder",
                                 folder.string(), error.message()));
  }
}

std::vector<TextLine> read_table(const std::filesystem::path& path) {
  std::istringstream content(read_text(path));
  std::vector<TextLine> lines;
  std::string text;
  for (size_t number = 1; std::getline(content, text); ++number) {
    std::istringstream words(text);
    TextLine line{number, {}};
    for (std::string word; words >> word;) line.fields.push_back(word);
    if (!line.fields.empty() && line.fields.front().front() != '#') lines.push_back(std::move(line));
  }
  return lines;
}

std::string read_file(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    if (error) throw_no_access(path, error);
    throw InputError(fmt::format("{}: no such file; check the path", path.string()));
  }
  if (!std::filesystem::is_regular_file(path, error)) {
    throw InputError(fmt::format("{}: not a regular file", path.string()));
  }
  std::ifstream stream(path, std::ios::binary);
  std::string content(std::filesystem::file_size(path, error), '\0');
  stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  if (stream.bad() || !stream.is_open() || error) {
    throw InputError(fmt::format("{}: cannot be read; check its permissions", path.string()));
  }
  content.resize(static_cast<size_t>(stream.gcount()));
  return content;
}

std::string read_text(const std::filesystem::path& path) {
  std::string bytes = read_file(path);
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // written by Windows editors
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF"))
    throw InputError(fmt::format("{}: text in UTF-16; save it as UTF-8", path.string()));
  if (bytes.starts_with(kByteOrderMark)) bytes.erase(0, kByteOrderMark.size());
  return bytes;
}

double parse_double(const std::string& text, const std::filesystem::path& path, size_t line) {
  double value = 0;
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw_parse_error(path, line,
                      fmt::format("'{}' is not a finite number; correct or delete the line", text));
  }
  return value;
}

void throw_parse_error(const std::filesystem::path& path, size_t line, const std::string& what) {
  throw InputError(fmt::format("{}:{}: {}", path.string(), line, printable(what)));  // it may quote the file
}

AtomicFile::AtomicFile(std::filesystem::path path, Durability durability)
    : file_(std::move(path), durability), stream_(file_.temporary(), std::ios::binary) {
  if (!stream_) throw InputError(fmt::format("{}: cannot be written", file_.path().string()));
}

void AtomicFile::commit(Existing existing) {
  stream_.close();
  if (stream_.fail())
    throw InputError(fmt::format("{}: writing failed; is the disk full?", file_.path().string()));
  file_.commit(existing);
}

void AtomicFile::keep_recording() noexcept {
  stream_.close();
  file_.keep_recording();
}

void write_file(const std::filesystem::path& path, std::string_view content, Durability durability) {
  AtomicFile file(path, durability);
  file.stream().write(content.data(), static_cast<std::streamsize>(content.size()));
  file.commit();
}

}  // namespace kinloop
