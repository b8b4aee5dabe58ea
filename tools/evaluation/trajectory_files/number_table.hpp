#pragma once
// In: a text file of numbers. Out: its rows, and the names of its columns where a line gives them.

#include <filesystem>
#include <string>
#include <vector>

#include "kinloop/core/files/text_file.hpp"

namespace kinloop {

/// Lines of numbers, separated by blanks, commas or semicolons.
struct NumberTable {
  std::vector<std::string> names;  ///< from a comment or a first line without numbers; empty if there is none
  std::vector<TextLine> rows;      ///< without comments; may differ in length
  bool has_commas = false;         ///< or semicolons
};

/// Throws InputError if the file cannot be read or has no row.
NumberTable read_number_table(const std::filesystem::path& path);

}  // namespace kinloop
