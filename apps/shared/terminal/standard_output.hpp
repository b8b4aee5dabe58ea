#pragma once
// Standard output: results for scripts, or the content of an output file (-o /dev/stdout).

#include <cstdio>
#include <filesystem>
#include <string>

namespace kinloop {

/// Opens those of the descriptors 0, 1 and 2 that are closed, so that no output file gets their number and
/// with it what is printed. Call it first.
void reserve_standard_descriptors();

/// Returns where to print what is said about a result in `output`: standard error if standard output carries
/// it.
std::FILE* message_stream(const std::filesystem::path& output);

/// Prints without an exception if that fails, see flush_standard_output: for what is said when the results
/// are written. Control characters, which a path may hold, are escaped but for line breaks and tabs.
void print_text(const std::string& text, std::FILE* stream = stdout);

/// Flushes standard output. Returns the error (errno) if something that was printed could not be written,
/// else 0.
int flush_standard_output();

}  // namespace kinloop
