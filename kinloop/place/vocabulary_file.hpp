#pragma once
// In: a dictionary. Out: its file, and back. The format (.kinvoc) is described in docs/place.md.

#include <filesystem>
#include <string>
#include <string_view>

#include "kinloop/place/vocabulary.hpp"

namespace kinloop {

/// The bytes of a dictionary file.
std::string serialize_vocabulary(const Vocabulary& vocabulary);

/// The dictionary in `bytes`. Throws InputError that begins with `name` for anything but a whole, unaltered
/// file of this kind and version.
Vocabulary parse_vocabulary(std::string_view bytes, const std::string& name);

/// Writes the file, atomically.
void write_vocabulary(const std::filesystem::path& path, const Vocabulary& vocabulary);

/// Reads the file; throws InputError as `parse_vocabulary` does, or when it cannot be read.
Vocabulary read_vocabulary(const std::filesystem::path& path);

}  // namespace kinloop
