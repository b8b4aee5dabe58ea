#include "session/store/command_files.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/io/run_folder.hpp"
#include "session/source/open_frame_source.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

/// The path without links, also of a file that does not exist yet.
fs::path resolved(const fs::path& path) {
  std::error_code unknown;
  fs::path found = fs::weakly_canonical(fs::absolute(path), unknown);
  if (unknown) return path;
  return found.has_filename() ? found : found.parent_path();  // of "folder/"
}

fs::path normal(const fs::path& path) {
  return fs::absolute(path).lexically_normal();
}

bool lies_in(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// Compares device and inode; false if one of them does not exist.
bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code absent;
  return fs::equivalent(a, b, absent);
}

/// A folder all of whose files are input.
struct InputFolder {
  fs::path given;
  std::vector<fs::path> folders;  ///< without links: itself, and those that links in it lead to
  std::vector<fs::path> links;    ///< in it, to files
};

InputFolder read_folder(const fs::path& given) {
  InputFolder input{given, {resolved(given)}, {}};
  std::error_code error;
  fs::recursive_directory_iterator entry(given, fs::directory_options::skip_permission_denied, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    std::error_code broken;
    if (!entry->is_symlink(broken)) continue;
    if (!entry->is_directory(broken)) {
      input.links.push_back(entry->path());
    } else if (fs::path target = resolved(entry->path()); !lies_in(input.folders.front(), target)) {
      input.folders.push_back(std::move(target));
    }
  }
  return input;
}

/// Returns another name that a file has in the folder; empty if there is none.
fs::path hard_link_in(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  if (fs::hard_link_count(file, error) < 2 || error) return {};
  const fs::path own_name = resolved(file);
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    if (is_same_file(entry->path(), file) && resolved(entry->path()) != own_name) return entry->path();
  }
  return {};
}

/// What a command reads.
struct Inputs {
  std::vector<fs::path> files;
  std::vector<InputFolder> folders;
};

Inputs inputs_of(const CommandFiles& files) {
  Inputs inputs{files.inputs, {}};
  for (const fs::path& recording : files.recordings) {
    std::error_code absent;
    if (fs::is_directory(recording, absent)) {
      inputs.folders.push_back(read_folder(recording));
    } else {
      inputs.files.push_back(recording);
    }
  }
  return inputs;
}

/// Throws UsageError if the output is an input, or a link of that name leads to it.
void require_no_input(const NamedOutput& output, const fs::path& file, const Inputs& inputs) {
  const auto refuse = [&](const fs::path& input) {
    throw UsageError(fmt::format("{} {}: would overwrite {}, which this command reads; {}", output.option,
                                 output.path.string(), input.string(), output.remedy));
  };
  std::error_code unknown;
  if (!fs::exists(file, unknown)) return;
  for (const fs::path& input : inputs.files) {
    if (is_same_file(file, input)) refuse(input);
  }
  for (const InputFolder& folder : inputs.folders) {
    for (const fs::path& link : folder.links) {
      if (is_same_file(file, link) && normal(link) != normal(file)) refuse(link);
    }
    if (const fs::path link = hard_link_in(folder.given, file); !link.empty()) refuse(link);
  }
}

/// Throws UsageError if the resolved path is in the folder of a recording.
void require_outside(const NamedOutput& output, const fs::path& path, const Inputs& inputs) {
  for (const InputFolder& input : inputs.folders) {
    for (const fs::path& folder : input.folders) {
      if (!lies_in(path, folder)) continue;
      throw UsageError(fmt::format(
          "{} {}: is in the folder of the recording, {}, whose files this command reads; give a name "
          "outside it",
          output.option, output.path.string(), input.given.string()));
    }
  }
}

/// Throws UsageError if the folder is that of a recording, or a file that will be written there is an input.
void check_results(const NamedResults& results, const Inputs& inputs) {
  const fs::path& folder = results.folder.path;
  for (const InputFolder& input : inputs.folders) {
    if (is_same_file(folder, input.given))
      throw UsageError(
          fmt::format("{} {}: is the folder of the recording, whose files would be overwritten; choose "
                      "another folder",
                      results.folder.option, folder.string()));
  }
  for (const std::string& name : results.names)
    require_no_input({results.folder.option, folder / name, "choose another folder"}, folder / name, inputs);
}

}  // namespace

void require_outputs(const CommandFiles& files) {
  const Inputs inputs = inputs_of(files);
  std::vector<fs::path> folders, written;
  for (const NamedResults& results : files.results) {
    if (results.folder.path.empty()) continue;
    check_results(results, inputs);
    folders.push_back(resolved(results.folder.path));
  }
  for (const NamedOutput& output : files.outputs) {
    if (output.path.empty()) continue;
    const OutputPlace place = output_place(output.path);
    if (place.is_stream) continue;
    const fs::path path = resolved(place.target);
    require_no_input(output, path, inputs);
    const auto holds_it = [&](const fs::path& folder) { return lies_in(path, folder); };
    if (std::none_of(folders.begin(), folders.end(), holds_it)) require_outside(output, path, inputs);
    const auto is_it = [&](const fs::path& other) { return other == path || is_same_file(other, path); };
    if (std::any_of(written.begin(), written.end(), is_it))
      throw UsageError(fmt::format("{} {}: is another output of this command, too; give different names",
                                   output.option, output.path.string()));
    written.push_back(path);
  }
  for (const NamedOutput& output : files.outputs) require_writable_file(output.path);
}

void add_input(CommandFiles& files, const fs::path& file_or_folder) {
  std::error_code absent;
  if (!fs::is_directory(file_or_folder, absent)) {
    files.inputs.push_back(file_or_folder);
  } else if (!fs::exists(file_or_folder / "run.json", absent) &&
             recognise_layout(file_or_folder) != nullptr) {
    files.recordings.push_back(file_or_folder);
  } else {
    for (const std::string& name : run_file_names()) files.inputs.push_back(file_or_folder / name);
  }
}

void add_sequence_input(CommandFiles& files, const std::string& sequence) {
  if (sequence == "-") {
    files.inputs.emplace_back("/dev/stdin");
  } else if (source_kind(sequence) != SourceKind::kLive) {
    files.recordings.push_back(sequence_folder(sequence));
  }
}

std::vector<NamedOutput> outputs_of(const std::string& option, const std::vector<fs::path>& paths) {
  std::vector<NamedOutput> outputs;
  for (const fs::path& path : paths) outputs.push_back({option, path});
  return outputs;
}

}  // namespace kinloop
