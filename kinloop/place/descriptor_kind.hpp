#pragma once
// What kind of descriptors a vocabulary is made of, and files say so.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "kinloop/features/options.hpp"

namespace kinloop {

/// The numbers stand in files. Runs use the kinds of 256 bits; the others are SIFT and SURF as they are.
enum class DescriptorKind : uint32_t { kOrb = 1, kSiftBinary = 2, kSurfBinary = 3, kSift = 4, kSurf = 5 };

/// How two descriptors are compared.
enum class Metric { kHamming, kEuclidean };

struct DescriptorTraits {
  DescriptorKind kind;
  Metric metric;
  size_t bytes;               ///< of one descriptor
  std::string_view feature;   ///< "orb", "sift" or "surf", as in FeatureOptions
  std::string_view name;      ///< for people
  std::string_view distance;  ///< its unit
};

/// What is known of a kind.
const DescriptorTraits& descriptor_traits(DescriptorKind kind);

/// The kind with this number in a file; nothing where there is none.
std::optional<DescriptorKind> descriptor_kind(uint32_t number);

/// What features of `options` give under `metric`; of ORB there are bits alone: nothing for Euclid.
std::optional<DescriptorKind> descriptor_kind(const FeatureOptions& options, Metric metric);

}  // namespace kinloop
