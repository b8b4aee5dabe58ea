#pragma once
// A chapter of the page of `kinloop reproduce`: commands of the program, and the tables and pictures they
// gave.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace kinloop {

/// Rows of text, the first of which is the heading.
using MarkdownTable = std::vector<std::vector<std::string>>;

struct Chapter {
  std::string title;
  std::string text;                   ///< what the paper has, and what follows
  std::vector<std::string> commands;  ///< in the order in which they ran
  std::vector<MarkdownTable> tables;
  std::vector<std::pair<std::string, std::string>> pictures;  ///< caption, and name relative to the page
  std::vector<std::pair<std::string, std::string>> links;     ///< the same for reports
  nlohmann::json figures;                                     ///< of the tables, with all digits
};

/// Runs `kinloop WORDS...` as a process of its own, notes it in the chapter and returns its standard output.
/// Throws InputError if it fails; its messages go to standard error.
std::string run_program(Chapter& chapter, const std::vector<std::string>& words);

/// Returns the chapter in Markdown.
std::string to_markdown(const Chapter& chapter);

}  // namespace kinloop
