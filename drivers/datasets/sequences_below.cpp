#include "drivers/datasets/sequences_below.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "drivers/datasets/folder_contents.hpp"
#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/text/did_you_mean.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

/// A folder of which a sequence is meant, though the names in it are no complete layout, or of no recording.
bool is_meant_itself(const fs::path& folder) {
  const FolderContents contents(folder);
  return is_incomplete_tum(contents) || is_run_folder(contents);
}

/// "FOLDER: contains 3 sequences"; one that was not looked through contains more.
std::string count_text(const fs::path& folder, const SequencesBelow& below) {
  const size_t count = below.names.size();
  return fmt::format("{}: contains {}{} sequence{}", folder.string(), below.complete ? "" : "at least ",
                     count, count == 1 ? "" : "s");
}

std::string list_text(const fs::path& folder, const SequencesBelow& below) {
  std::string text = "Sequences:\n";
  for (const std::string& name : below.names)
    text += fmt::format("  {}  ({})\n", name, recognise_layout(folder / name)->name);
  return below.complete ? text : text + "  ...\n";
}

/// Leads out of the folder.
bool is_outside(const fs::path& name) {
  return name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end();
}

[[noreturn]] void reject_name(const fs::path& folder, const std::string& name) {
  const SequencesBelow below = sequences_below(folder);
  if (below.names.empty())
    throw InputError(
        fmt::format("{}: no sequence {} in it; give the folder that is above it", folder.string(), name));
  throw InputErrorWithHint(
      fmt::format("{}, but no '{}'{}", count_text(folder, below), name, did_you_mean(name, below.names)),
      list_text(folder, below));
}

/// The folders in another one that may be sequences or hold some, by their paths below `top`.
std::vector<fs::path> folders_in(const fs::path& top, const fs::path& above) {
  std::vector<fs::path> found;
  const FolderContents contents(top / above);
  for (const std::string& name : contents.folders()) {
    if (!name.starts_with('.')) found.push_back(above / name);
  }
  return found;
}

}  // namespace

SequencesBelow sequences_below(const fs::path& folder) {
  constexpr size_t kMaxDepth = 4, kMaxFolders = 1000;
  SequencesBelow found;
  std::vector<fs::path> level = folders_in(folder, {});
  size_t looked_at = 0;
  for (size_t depth = 1; !level.empty(); ++depth) {
    std::vector<fs::path> next;
    for (const fs::path& below : level) {
      if (++looked_at > kMaxFolders) {
        found.complete = false;
        break;
      }
      if (is_run_folder(FolderContents(folder / below))) continue;
      if (recognise_layout(folder / below) != nullptr) {
        found.names.push_back(below.string());
      } else if (depth < kMaxDepth) {
        const auto inside = folders_in(folder, below);
        next.insert(next.end(), inside.begin(), inside.end());
      }
    }
    level = std::move(next);
  }
  std::sort(found.names.begin(), found.names.end());
  return found;
}

fs::path sequence_folder(const fs::path& path, const std::string& name) {
  if (const auto packed = archive_of(path)) return packed->archive;
  if (!name.empty()) {
    const fs::path chosen = (path / name).lexically_normal();
    if (is_outside(name) || recognise_layout(chosen) == nullptr) reject_name(path, name);
    return chosen;
  }
  std::error_code absent;
  if (!fs::is_directory(path, absent) || recognise_layout(path) != nullptr || is_meant_itself(path))
    return path;
  const SequencesBelow below = sequences_below(path);
  return below.complete && below.names.size() == 1 ? path / below.names.front() : path;
}

std::string LocatedSequence::shown(const std::string& message) const {
  return unpacked ? unpacked->shown(message) : message;
}

LocatedSequence locate_sequence(const fs::path& path, const std::string& name) {
  LocatedSequence located{name.empty() ? path.string() : (path / name).string(), path, {}, nullptr};
  if (const auto packed = archive_of(path)) {
    located.unpacked = std::make_shared<const UnpackedArchive>(packed->archive);
    located.top = located.unpacked->folder();
    if (!packed->inside.empty()) located.top /= packed->inside;
  }
  located.folder = with_shown_paths(located, [&] { return sequence_folder(located.top, name); });
  if (name.empty() && located.folder != located.top)
    log::info("{}: contains one sequence, {}, which is taken", path.string(),
              located.shown(located.folder.string()));
  return located;
}

void reject_several_sequences(const fs::path& folder) {
  const SequencesBelow below = sequences_below(folder);
  if (below.names.empty()) return;
  const std::string& first = below.names.front();
  throw InputErrorWithHint(fmt::format("{}; choose one: --sequence {}, or give its folder, {}",
                                       count_text(folder, below), first, (folder / first).string()),
                           list_text(folder, below));
}

}  // namespace kinloop
