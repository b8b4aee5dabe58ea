#pragma once

namespace kinloop {

/// Has the allocator keep freed memory for what comes next; to be called once, at the start.
void retain_freed_memory();

/// Gives freed memory back to the system: between stages that need memory of different shapes.
void release_freed_memory();

}  // namespace kinloop
