#pragma once
// In: the path of an output. Out: a temporary file to write to, and its content at that path once it is
// complete.

#include <filesystem>
#include <optional>

namespace kinloop {

/// Where the content of an output goes.
struct OutputPlace {
  std::filesystem::path target;   ///< the file to replace, after symbolic links, or a pipe or device
  bool is_stream = false;         ///< a pipe, a device or a descriptor of this process: written through
  std::optional<int> descriptor;  ///< of this process, as for /dev/stdout
};

/// Follows symbolic links, also those to a file that does not exist yet. Throws InputError for a folder and
/// for anything else that cannot be written to.
OutputPlace output_place(const std::filesystem::path& path);

/// Returns whether `path` is standard output, by one of its names: what else is printed would mix with the
/// content.
bool is_standard_output(const std::filesystem::path& path);

/// When the content is on the disk: many small files are faster flushed together.
enum class Durability { kAtOnce, kWithTheOthers };

/// What becomes of an older file of the same name.
enum class Existing { kReplaced, kKept };

/// An output, written to a temporary file. Without `commit()` (an exception, a kill) an existing file stays
/// as it is. The temporary file is locked while it is in use, so that those of killed processes can be told
/// apart.
class OutputFile {
 public:
  /// Creates the temporary file: beside the target, with the owner and the permissions of the file that it
  /// will replace; for a stream among the system's temporary files. Throws InputError on failure.
  explicit OutputFile(std::filesystem::path path, Durability durability = Durability::kAtOnce);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// The file to write and to close before `commit()`.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }

  /// Flushes the content to the disk and renames the file, or copies it to the stream. Throws InputError on
  /// failure, and if there is an older file that is to be kept.
  void commit(Existing existing = Existing::kReplaced);

  /// Gives a recording that is incomplete, or whose commit failed, its name if that is free, else
  /// recovered-PID-N.mcap: a part is better than nothing.
  void keep_recording() noexcept;

 private:
  void take_name(Existing existing);
  void copy_to_stream() const;
  [[noreturn]] void fail(int error) const;

  std::filesystem::path path_;
  OutputPlace place_;
  std::filesystem::path temporary_;
  Durability durability_;
  int descriptor_ = -1;  ///< of the temporary file; holds its lock
};

/// Removes the temporary files that killed processes left in `folder`. MCAP files, which are recordings, are
/// kept and named recovered-PID-N.mcap: they can be read up to the kill.
void clear_abandoned_files(const std::filesystem::path& folder);

/// Flushes all files written with Durability::kWithTheOthers on the disk of `folder`.
void flush_files(const std::filesystem::path& folder);

}  // namespace kinloop
