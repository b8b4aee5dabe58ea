#pragma once
// In: a folder that is no sequence itself. Out: the sequences in the folders below it, and the one that is
// meant. Only file names are examined.

#include <filesystem>
#include <string>
#include <vector>

namespace kinloop {

/// Sequences in the folders below one, relative to it and in order of name.
struct SequencesBelow {
  std::vector<std::string> names;
  bool complete =
      true;  ///< false: there are more folders than are looked at, and there may be more sequences
};

/// Returns the sequences up to four folders down: neither those within another, nor what a run has written.
SequencesBelow sequences_below(const std::filesystem::path& folder);

/// Returns the sequence `name` below `path`. Without a name: `path` if it is a sequence or has not exactly
/// one below it, else that one. Throws InputError naming the sequences that there are if `name` is none of
/// them.
std::filesystem::path sequence_folder(const std::filesystem::path& path, const std::string& name = {});

/// Throws InputError if there are sequences below a folder: names them, and says how one is chosen.
void reject_several_sequences(const std::filesystem::path& folder);

}  // namespace kinloop
