#pragma once
// Text files, read line by line with errors that name file and line, and output files that are written beside
// their target and renamed.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "kinloop/core/files/output_file.hpp"

namespace kinloop {

/// One line of a table: its number (from 1) and its whitespace-separated fields.
struct TextLine {
  size_t number = 0;
  std::vector<std::string> fields;
};

/// Throws InputError for a path that the system does not let this user look at: no permission, or too long.
[[noreturn]] void throw_no_access(const std::filesystem::path& path, const std::error_code& error);

/// Throws InputError unless `folder` exists and is a folder.
void require_folder(const std::filesystem::path& folder);

/// Throws InputError unless `path` is a file: to open a pipe would wait for its other end.
void require_regular_file(const std::filesystem::path& path);

/// Creates the folder and its missing parents. Throws InputError on failure.
void make_folder(const std::filesystem::path& folder);

/// Calls `visit` for each line of a whitespace-separated table without blank lines, lines that begin with '#'
/// and the byte-order mark; holds one line in memory, whatever the size of the file. Throws InputError if the
/// file cannot be read, for UTF-16 and for a line of more than 1 MiB.
void visit_table(const std::filesystem::path& path, const std::function<void(TextLine line)>& visit);

/// The most that a list of the frames of a recording has: half a million frames and more. In memory its words
/// take up to twenty times as much.
constexpr uint64_t kMostListBytes = uint64_t{32} << 20;

/// Returns the lines of such a table. Throws InputError for a file of more than kMostListBytes.
std::vector<TextLine> read_table(const std::filesystem::path& path);

/// Throws InputError for a file of more than `most_bytes`, before it is read.
void require_size(const std::filesystem::path& path, uint64_t most_bytes);

/// Returns the whole file as bytes. Throws InputError if it cannot be read.
std::string read_file(const std::filesystem::path& path);

/// Returns the same of a text file, without the byte-order mark. Throws InputError for UTF-16.
std::string read_text(const std::filesystem::path& path);

/// Parses all of `text` as a finite number; throws InputError naming file, line and text otherwise.
double parse_double(const std::string& text, const std::filesystem::path& path, size_t line);

/// Throws InputError with the message "FILE:LINE: what".
[[noreturn]] void throw_parse_error(const std::filesystem::path& path, size_t line, const std::string& what);

/// An output file that appears under its name only when complete, see OutputFile.
class AtomicFile {
 public:
  /// Throws InputError if the file cannot be created.
  explicit AtomicFile(std::filesystem::path path, Durability durability = Durability::kAtOnce);

  std::ostream& stream() { return stream_; }

  /// Flushes, checks that everything was written (a full disk throws InputError) and renames.
  void commit(Existing existing = Existing::kReplaced);

  /// See OutputFile.
  void keep_recording() noexcept;

 private:
  OutputFile file_;
  std::ofstream stream_;
};

/// Writes `content` as the whole file, atomically.
void write_file(const std::filesystem::path& path, std::string_view content,
                Durability durability = Durability::kAtOnce);

}  // namespace kinloop
