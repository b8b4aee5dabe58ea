#pragma once
// Error messages for invalid command lines, with the remedy.

#include <span>
#include <string>

#include <CLI/CLI.hpp>

namespace kinloop {

/// Returns the full name of a command, "kinloop map merge".
std::string full_name(const CLI::App& app);

/// Returns the command that `words` begin with. Throws UsageError with the nearest name if there is none.
const CLI::App& find_command(const CLI::App& program, std::span<const std::string> words);

/// Returns the message for a command line that CLI11 rejected: the command, the offending word, and what was
/// expected. Unknown options come first, since they make others seem to be missing.
std::string explain_parse_error(const CLI::ParseError& error, const CLI::App& program,
                                std::span<const std::string> words);

}  // namespace kinloop
