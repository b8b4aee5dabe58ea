#pragma once
// Changes the values in the rows of a map file.

#include <cstddef>
#include <cstdint>

namespace kinloop::fuzz {

/// As LLVMFuzzerCustomMutator: changes the input in place and returns its new size.
size_t mutate_map(uint8_t* data, size_t size, size_t max_size, unsigned seed);

}  // namespace kinloop::fuzz
