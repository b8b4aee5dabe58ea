#pragma once
// What is wrong with a command line, said so that it can be put right.

#include <span>
#include <string>

#include <CLI/CLI.hpp>

namespace kinloop {

/// "kinloop map merge": a command with those above it.
std::string full_name(const CLI::App& app);

/// The command that `words` begin with. Throws UsageError that names the nearest where it is none.
const CLI::App& find_command(const CLI::App& program, std::span<const std::string> words);

/// The message for a command line that CLI11 rejected: the command, what is wrong with which word, and what
/// was expected. An unknown option comes first: it is why others seem to be missing.
std::string explain_parse_error(const CLI::ParseError& error, const CLI::App& program,
                                std::span<const std::string> words);

}  // namespace kinloop
