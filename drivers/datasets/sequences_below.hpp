#pragma once
// In: a folder that is no sequence itself, or an archive. Out: the sequences in the folders below it, and the
// one that is meant. Only file names are examined.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drivers/archives/unpacked_archive.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {

/// Sequences in the folders below one, relative to it and in order of name.
struct SequencesBelow {
  std::vector<std::string> names;
  /// False: there are more folders than are looked at, and there may be more sequences.
  bool complete = true;
};

/// Returns the sequences up to four folders down: neither those within another, nor what a run has written.
SequencesBelow sequences_below(const std::filesystem::path& folder);

/// Returns the archive of a path into one, which is not unpacked. Else the sequence `name` below `path`.
/// Without a name: `path` if it is a sequence or has not exactly one below it, else that one. Throws
/// InputError naming the sequences that there are if `name` is none of them.
std::filesystem::path sequence_folder(const std::filesystem::path& path, const std::string& name = {});

/// Where the files of a sequence are.
struct LocatedSequence {
  std::string shown_name;                           ///< as the user can give it again
  std::filesystem::path top;                        ///< the folder that was given; of an archive, all of it
  std::filesystem::path folder;                     ///< the sequence, see sequence_folder
  std::shared_ptr<const UnpackedArchive> unpacked;  ///< keeps the files, if they are of an archive; else null

  /// Returns a message with paths as the user knows them.
  [[nodiscard]] std::string shown(const std::string& message) const;
};

/// Returns where the sequence `name` in a folder or archive is, or the only one, which is said; unpacks an
/// archive. Throws InputError as sequence_folder and UnpackedArchive do.
LocatedSequence locate_sequence(const std::filesystem::path& path, const std::string& name = {});

/// Calls `read`. The errors that it throws name paths as the user knows them.
template <class Read>
auto with_shown_paths(const LocatedSequence& located, const Read& read) {
  try {
    return read();
  } catch (const InputErrorWithHint& error) {
    if (!located.unpacked) throw;
    throw InputErrorWithHint(located.shown(error.what()), located.shown(error.hint()));
  } catch (const InputError& error) {
    if (!located.unpacked) throw;
    throw InputError(located.shown(error.what()));
  }
}

/// Throws InputError if there are sequences below a folder: names them, and says how one is chosen.
void reject_several_sequences(const std::filesystem::path& folder);

}  // namespace kinloop
