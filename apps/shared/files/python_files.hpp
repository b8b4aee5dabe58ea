#pragma once
// Parts of the Python package that the program starts. They need Python, but not the package's module.

#include <filesystem>
#include <string>
#include <vector>

namespace kinloop {

/// Returns the file of this process; a process that it starts has another /proc/self.
std::filesystem::path own_program();

/// Returns PREFIX/share/kinloop/NAME of the program PREFIX/bin/kinloop; the build tree has the same places.
/// Throws InputError if it is not installed.
std::filesystem::path python_file(const std::string& name);

/// Runs `python3 SCRIPT WORDS...` and shows lines "warning: ..." that it prints. Throws InputError with what
/// it printed if it fails.
void run_python(const std::filesystem::path& script, std::vector<std::string> words);

}  // namespace kinloop
