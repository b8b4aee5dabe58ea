#include "session/store/command_files.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/sequences_below.hpp"
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

/// Returns the images outside of the folder that its lists name; none if it cannot be read, which the command
/// will say.
std::vector<fs::path> images_outside(const fs::path& folder) {
  const SequenceLayout* layout = recognise_layout(folder);
  if (layout == nullptr) return {};
  const fs::path inside = normal(folder / "").parent_path();  // without the slash at its end
  std::vector<fs::path> images;
  const auto add = [&](const fs::path& image) {
    if (!image.empty() && !lies_in(normal(image), inside)) images.push_back(image);
  };
  try {
    const RecordedSequence sequence = layout->read(folder);
    add(sequence.video);
    for (const RecordedFrame& frame : sequence.frames) {
      for (const fs::path& image : {frame.color.file, frame.depth.file, frame.confidence, frame.mask})
        add(image);
    }
  } catch (const InputError&) {
    return {};
  }
  return images;
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

/// Returns whether a run has written its results there, and there is no recording.
bool is_folder_of_results(const fs::path& folder) {
  std::error_code absent;
  return fs::exists(folder / "run.json", absent) && recognise_layout(folder) == nullptr;
}

/// What a command reads.
struct Inputs {
  std::vector<fs::path> files;
  std::vector<InputFolder> folders;
};

/// Returns whether an output is there already.
bool replaces_a_file(const CommandFiles& files) {
  return std::any_of(files.outputs.begin(), files.outputs.end(), [](const NamedOutput& output) {
    std::error_code absent;
    return fs::is_regular_file(output.path, absent);
  });
}

Inputs inputs_of(const CommandFiles& files) {
  Inputs inputs{files.inputs, {}};
  const bool replaces = replaces_a_file(files);  // if not, the lists of long recordings need not be read
  for (const fs::path& recording : files.recordings) {
    std::error_code absent;
    if (fs::is_directory(recording, absent)) {
      inputs.folders.push_back(read_folder(recording));
      if (!replaces) continue;
      for (fs::path& image : images_outside(recording)) inputs.files.push_back(std::move(image));
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
  std::vector<fs::path> folders;
  std::vector<std::pair<fs::path, std::string>> written;  // each with its option
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
    for (const auto& [other, option] : written) {
      if (other == path || is_same_file(other, path))
        throw UsageError(fmt::format("{} {}: is the output of {}, too; give different names", output.option,
                                     output.path.string(), option));
    }
    written.emplace_back(path, output.option);
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

void add_sequence_input(CommandFiles& files, const std::string& sequence, const std::string& chosen) {
  if (sequence == "-") {
    files.inputs.emplace_back("/dev/stdin");
  } else if (const SourceKind kind = source_kind(sequence); kind != SourceKind::kLive) {
    const fs::path folder =
        kind == SourceKind::kFolder ? sequence_folder(sequence, chosen) : fs::path(sequence);
    if (!is_folder_of_results(folder)) files.recordings.push_back(folder);
  }
}

std::vector<NamedOutput> outputs_of(const std::string& option, const std::vector<fs::path>& paths) {
  std::vector<NamedOutput> outputs;
  for (const fs::path& path : paths) outputs.push_back({option, path});
  return outputs;
}

}  // namespace kinloop
