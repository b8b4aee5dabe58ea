#pragma once
// In: a vocabulary. Out: its file, and back. docs/method.md describes the format (.kinvoc).

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "kinloop/place/vocabulary/vocabulary.hpp"

namespace kinloop {

/// Returns the bytes of a vocabulary file.
std::string serialize_vocabulary(const Vocabulary& vocabulary);

/// Parses the vocabulary in `bytes` (aligned to 4) without copying: `owner` keeps them alive, or they have
/// static lifetime. Throws InputError beginning with `name` unless the file is complete and unaltered.
Vocabulary parse_vocabulary(std::string_view bytes, const std::string& name,
                            std::shared_ptr<const void> owner);

/// Writes the file atomically.
void write_vocabulary(const std::filesystem::path& path, const Vocabulary& vocabulary);

/// Reads the file into memory, so that nothing that happens to it afterwards matters. Throws InputError as
/// `parse_vocabulary` does, or if the file cannot be read.
Vocabulary read_vocabulary(const std::filesystem::path& path);

}  // namespace kinloop
