#include "kinloop/core/files/text_file.hpp"

#include <array>
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
    throw OutputError(fmt::format("{}: cannot create the folder ({}); choose another output folder",
                                  folder.string(), error.message()));
  }
}

namespace {

/// Takes the byte-order mark off the first line.
void begin_text(std::string& text, const std::filesystem::path& path) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // written by Windows editors
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw InputError(fmt::format("{}: text in UTF-16; save it as UTF-8", path.string()));
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
}

/// Reads up to the next line break; false at the end of the file.
bool read_line(std::istream& stream, std::string& text, const std::filesystem::path& path, size_t number) {
  constexpr size_t kMostBytes = size_t{1} << 20;
  text.clear();
  std::array<char, 4096> part;
  while (stream.getline(part.data(), part.size()) || stream.gcount() > 0) {
    const bool cut = stream.fail() && !stream.eof();  // the line goes on
    text.append(part.data(), static_cast<size_t>(stream.gcount()) - (stream.good() ? 1 : 0));
    if (text.size() > kMostBytes)
      throw_parse_error(path, number, "a line of more than 1 MiB; this is no table of numbers and names");
    if (!cut) return true;
    stream.clear();
  }
  return false;
}

}  // namespace

void visit_table(const std::filesystem::path& path, const std::function<void(TextLine line)>& visit) {
  require_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: cannot be read; check its permissions", path.string()));
  std::string text;
  for (size_t number = 1; read_line(stream, text, path, number); ++number) {
    if (number == 1) begin_text(text, path);
    std::istringstream words(text);
    TextLine line{number, {}};
    for (std::string word; words >> word;) line.fields.push_back(word);
    if (!line.fields.empty() && line.fields.front().front() != '#') visit(std::move(line));
  }
  if (stream.bad()) throw InputError(fmt::format("{}: cannot be read; copy it again", path.string()));
}

std::vector<TextLine> read_table(const std::filesystem::path& path) {
  require_size(path, kMostListBytes);
  std::vector<TextLine> lines;
  visit_table(path, [&](TextLine line) { lines.push_back(std::move(line)); });
  return lines;
}

void require_size(const std::filesystem::path& path, uint64_t most_bytes) {
  require_regular_file(path);
  std::error_code unknown;
  const uint64_t bytes = std::filesystem::file_size(path, unknown);
  if (unknown || bytes <= most_bytes) return;
  throw InputError(fmt::format("{}: {} bytes, where such a file has at most {}; split the recording",
                               path.string(), bytes, most_bytes));
}

void require_regular_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw InputError(fmt::format("{}: no such file; check the path", path.string()));
  if (error) throw_no_access(path, error);
  if (std::filesystem::is_regular_file(status)) return;
  const char* kind = std::filesystem::is_directory(status) ? "a folder"
                     : std::filesystem::is_fifo(status)    ? "a pipe"
                     : std::filesystem::is_socket(status)  ? "a socket"
                                                           : "a device";
  throw InputError(fmt::format("{}: {}, not a regular file; put a file in its place", path.string(), kind));
}

std::string read_file(const std::filesystem::path& path) {
  require_regular_file(path);
  std::error_code error;
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
  begin_text(bytes, path);
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
  if (!stream_) throw OutputError(fmt::format("{}: cannot be written", file_.path().string()));
}

void AtomicFile::commit(Existing existing) {
  stream_.close();
  if (stream_.fail())
    throw OutputError(fmt::format("{}: writing failed; is the disk full?", file_.path().string()));
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
