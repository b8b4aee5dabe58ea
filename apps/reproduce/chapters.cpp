#include "apps/reproduce/chapters.hpp"

#include <array>
#include <cstdio>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/shared/files/python_files.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {

namespace {

constexpr const char* kPlainCharacters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";

/// The word as a shell reads it.
std::string quoted(const std::string& word) {
  if (!word.empty() && word.find_first_not_of(kPlainCharacters) == std::string::npos) return word;
  std::string inner;
  for (const char c : word) {
    if (c == '\'') inner.append("'\\'");
    inner.push_back(c);
  }
  return fmt::format("'{}'", inner);
}

std::string joined(const std::string& program, const std::vector<std::string>& words) {
  std::string line = program;
  for (const std::string& word : words) line += fmt::format(" {}", quoted(word));
  return line;
}

std::string table_text(const MarkdownTable& table) {
  std::string text;
  for (size_t i = 0; i < table.size(); ++i) {
    text += fmt::format("| {} |\n", fmt::join(table[i], " | "));
    if (i > 0) continue;
    text += '|';
    for (size_t column = 0; column < table[i].size(); ++column) text += "---|";
    text += '\n';
  }
  return text;
}

}  // namespace

std::string run_program(Chapter& chapter, const std::vector<std::string>& words) {
  const std::string shown = joined("kinloop", words);
  log::info("{}", shown);
  chapter.commands.push_back(shown);
  FILE* pipe = popen(joined(quoted(own_program().string()), words).c_str(), "r");
  if (pipe == nullptr) throw InputError("cannot start a process");
  std::string output;
  std::array<char, 4096> block{};
  while (const size_t bytes = std::fread(block.data(), 1, block.size(), pipe)) {
    output.append(block.data(), bytes);
  }
  if (pclose(pipe) != 0) throw InputError(fmt::format("{}: failed, see above", shown));
  return output;
}

std::string to_markdown(const Chapter& chapter) {
  std::string text = fmt::format("## {}\n\n{}\n", chapter.title, chapter.text);
  if (!chapter.commands.empty()) text += fmt::format("\n```\n{}\n```\n", fmt::join(chapter.commands, "\n"));
  for (const MarkdownTable& table : chapter.tables) text += fmt::format("\n{}", table_text(table));
  for (const auto& [caption, file] : chapter.pictures) text += fmt::format("\n![{}]({})\n", caption, file);
  for (const auto& [caption, file] : chapter.links) text += fmt::format("\n[{}]({})\n", caption, file);
  return text;
}

}  // namespace kinloop
