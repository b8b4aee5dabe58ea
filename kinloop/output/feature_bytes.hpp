#pragma once
// Key points as bytes and back, to the last bit.

#include <optional>
#include <string>

#include "kinloop/features/features.hpp"

namespace kinloop {

std::string bytes_of(const Features& features);

/// Nothing where the bytes are not what `bytes_of` gave.
std::optional<Features> features_from(const std::string& bytes);

}  // namespace kinloop
