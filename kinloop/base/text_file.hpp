#pragma once
// Text files read line by line with errors that name file and line, and files written beside and renamed.

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace kinloop {

/// One line of a table: its number (from 1) and its fields, split at white space.
struct TextLine {
  size_t number = 0;
  std::vector<std::string> fields;
};

/// Throws InputError unless `folder` is a folder that exists.
void require_folder(const std::filesystem::path& folder);

/// Makes the folder, and those above it, where they are not there. Throws InputError when it cannot be made.
void make_folder(const std::filesystem::path& folder);

/// The lines of a white-space table; blank lines, lines that begin with '#' and a byte-order mark are left
/// out. Throws InputError when the file cannot be read.
std::vector<TextLine> read_table(const std::filesystem::path& path);

/// The whole file as bytes. Throws InputError when it cannot be read.
std::string read_file(const std::filesystem::path& path);

/// A finite number from all of `text`. Throws InputError naming file, line and text otherwise.
double parse_double(const std::string& text, const std::filesystem::path& path, size_t line);

/// "FILE:LINE: what", thrown as InputError.
[[noreturn]] void throw_parse_error(const std::filesystem::path& path, size_t line, const std::string& what);

/// An output file that appears under its name only when it is complete: written as "NAME.tmp", renamed by
/// `commit()`. Without a commit (an exception, a kill) an older file of that name stays as it was.
class AtomicFile {
 public:
  /// Throws InputError when the file cannot be created.
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream& stream() { return stream_; }

  /// Flushes, checks that everything was written (a full disk throws InputError) and renames.
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  std::ofstream stream_;
  bool committed_ = false;
};

/// Writes `content` as the whole file, atomically.
void write_file(const std::filesystem::path& path, std::string_view content);

}  // namespace kinloop
