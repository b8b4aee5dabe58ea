#pragma once
// Exact serialisation of keypoints.

#include <optional>
#include <string>

#include "kinloop/features/features.hpp"

namespace kinloop {

std::string serialize_features(const Features& features);

/// Returns nullopt if `serialize_features` did not produce the bytes.
std::optional<Features> deserialize_features(const std::string& bytes);

}  // namespace kinloop
