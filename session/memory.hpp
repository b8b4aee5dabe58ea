#pragma once

namespace kinloop {

/// Makes the allocator keep freed memory for reuse; call it once, at the start.
void retain_freed_memory();

/// Returns freed memory to the system, between stages with different memory needs.
void release_freed_memory();

}  // namespace kinloop
