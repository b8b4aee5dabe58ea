#pragma once
// In: the files that a command reads, and those that it will write. Out: an error before any work is done if
// it would write one that it reads.

#include <filesystem>
#include <string>
#include <vector>

namespace kinloop {

/// A file or folder that a command writes.
struct NamedOutput {
  std::string option;  ///< that names it, "--plot"
  std::filesystem::path path;
  std::string remedy = "give another name";  ///< if it is an input
};

/// A folder in which a command writes files under fixed names.
struct NamedResults {
  NamedOutput folder;
  std::vector<std::string> names;  ///< of the files
};

/// What a command reads and writes. Empty paths stand for what the user has not asked for.
struct CommandFiles {
  /// Files; what is none, such as the name of a camera, is ignored.
  std::vector<std::filesystem::path> inputs = {};
  /// Each a file, or a folder with all that is in it.
  std::vector<std::filesystem::path> recordings = {};
  /// Files; pipes and devices are ignored.
  std::vector<NamedOutput> outputs = {};
  /// May be in the folder of a recording.
  std::vector<NamedResults> results = {};
};

/// Throws UsageError if two outputs are one file, or one is an input, or is one in the folder of a recording
/// but not in a folder of results, whatever its name and the links on its way. Then throws InputError if one
/// cannot be written.
void require_outputs(const CommandFiles& files);

/// Adds a file, all files of a recording, or those of a run's folder.
void add_input(CommandFiles& files, const std::filesystem::path& file_or_folder);

/// Adds what kinloop run would read of the sequence: a file, a folder or standard input; nothing of a camera,
/// or of a folder that holds no sequence but the results of a run. `chosen` is as in SourceRequest.
void add_sequence_input(CommandFiles& files, const std::string& sequence, const std::string& chosen = {});

/// Returns the outputs that the same option names.
std::vector<NamedOutput> outputs_of(const std::string& option,
                                    const std::vector<std::filesystem::path>& paths);

}  // namespace kinloop
