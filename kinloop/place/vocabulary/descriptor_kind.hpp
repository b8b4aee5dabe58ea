#pragma once
// The descriptor type of a vocabulary, as recorded in its file.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "kinloop/features/options.hpp"

namespace kinloop {

/// The numbers are used in files. Runs use the 256-bit kinds; the others are the original SIFT and SURF.
enum class DescriptorKind : uint32_t { kOrb = 1, kSiftBinary = 2, kSurfBinary = 3, kSift = 4, kSurf = 5 };

/// Distance measure of descriptors.
enum class Metric { kHamming, kEuclidean };

struct DescriptorTraits {
  DescriptorKind kind;
  Metric metric;
  size_t bytes;               ///< of one descriptor
  FeatureKind feature;        ///< the detector that computes them
  std::string_view name;      ///< for display
  std::string_view distance;  ///< unit of the distance
};

/// Returns the properties of a kind.
const DescriptorTraits& descriptor_traits(DescriptorKind kind);

/// Returns the kind with this number in a file; nullopt if unknown.
std::optional<DescriptorKind> descriptor_kind(uint32_t number);

/// Returns the kind that extraction with `options` gives under `metric`; nullopt for ORB with Euclidean
/// distance.
std::optional<DescriptorKind> descriptor_kind(const FeatureOptions& options, Metric metric);

}  // namespace kinloop
