#pragma once
// The text format of vocabularies by DBoW2 (Galvez-Lopez and Tardos 2012) and ORB-SLAM: a first line
// "branching depth scoring weighting", then a line for each node but the root: "parent is_word 32 bytes
// weight", numbered from 1 in the order of lines; the root is 0.

#include <filesystem>

#include "kinloop/place/vocabulary/vocabulary.hpp"

namespace kinloop {

/// Reads such a file of ORB words; use counts are unknown. Throws InputError naming file and line.
Vocabulary read_dbow2(const std::filesystem::path& path);

/// Writes such a file. Throws InputError if the vocabulary is not of 256 bits.
void write_dbow2(const std::filesystem::path& path, const Vocabulary& vocabulary);

}  // namespace kinloop
