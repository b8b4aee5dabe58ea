#pragma once
// What concerns the whole process: its name, its stack and its memory.

#include <string>

namespace kinloop {

/// Returns "kinloop" and its version.
std::string program_name();

/// Throws UsageError if the system limits the stack so far that the program would crash.
void require_stack();

/// Makes the allocator keep freed memory for reuse; call it once, at the start.
void retain_freed_memory();

/// Returns freed memory to the system, between stages with different memory needs.
void release_freed_memory();

}  // namespace kinloop
