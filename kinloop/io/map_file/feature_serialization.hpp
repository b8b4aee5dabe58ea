#pragma once
// Keypoints as bytes and back, to the last bit.

#include <optional>
#include <string>

#include "kinloop/features/features.hpp"

namespace kinloop {

std::string serialize_features(const Features& features);

/// Nothing where the bytes are not what `serialize_features` gave.
std::optional<Features> deserialize_features(const std::string& bytes);

}  // namespace kinloop
