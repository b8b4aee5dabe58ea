#pragma once
// Binary descriptors as plain values that can be copied, sorted and stored.

#include <array>
#include <cstdint>

#include "kinloop/features/hamming.hpp"

namespace kinloop {

/// One ORB descriptor: 256 bits, compared by Hamming distance.
using BinaryDescriptor = std::array<uint8_t, kOrbBytes>;

}  // namespace kinloop
