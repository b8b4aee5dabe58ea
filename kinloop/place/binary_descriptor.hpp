#pragma once
// In: the rows of a descriptor matrix. Out: descriptors as plain values that can be copied, sorted and
// stored.

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/features/hamming.hpp"

namespace kinloop {

/// One ORB descriptor: 256 bits, compared by Hamming distance.
using BinaryDescriptor = std::array<uint8_t, kOrbBytes>;

/// The rows of an N x 32 matrix of bytes; an empty matrix gives none.
std::vector<BinaryDescriptor> to_binary_descriptors(const cv::Mat& descriptors);

}  // namespace kinloop
