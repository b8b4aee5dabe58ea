#pragma once
// In: a vocabulary. Out: its file, and back. The format (.kinvoc) is described in docs/place.md.

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "kinloop/place/vocabulary.hpp"

namespace kinloop {

/// The bytes of a vocabulary file.
std::string serialize_vocabulary(const Vocabulary& vocabulary);

/// The vocabulary in `bytes` (aligned to 4), which it looks at and does not copy: `owner` keeps them, or they
/// never go. Throws InputError that begins with `name` for anything but a whole, unaltered file.
Vocabulary parse_vocabulary(std::string_view bytes, const std::string& name,
                            std::shared_ptr<const void> owner);

/// Writes the file, atomically.
void write_vocabulary(const std::filesystem::path& path, const Vocabulary& vocabulary);

/// Maps the file into memory: pages are read when words are looked up. Throws InputError as
/// `parse_vocabulary` does, or when it cannot be read.
Vocabulary read_vocabulary(const std::filesystem::path& path);

}  // namespace kinloop
