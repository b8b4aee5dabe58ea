#pragma once
// In: names of colour and depth images. Out: which are equal but for words such as "color" and "depth".

#include <filesystem>
#include <vector>

#include "kinloop/core/association.hpp"

namespace kinloop {

/// Returns the pairs of equal numbers in the names, as indices into both lists in the order of colour.
/// Numbers that are the same in all names do not count, nor do leading zeros. None if two names of a list are
/// equal.
std::vector<StampPair> pairs_of_equal_names(const std::vector<std::filesystem::path>& color,
                                            const std::vector<std::filesystem::path>& depth);

}  // namespace kinloop
