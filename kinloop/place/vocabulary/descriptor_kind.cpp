#include "kinloop/place/vocabulary/descriptor_kind.hpp"

#include <algorithm>
#include <array>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

constexpr std::array<DescriptorTraits, 5> kKinds{{
    {DescriptorKind::kOrb, Metric::kHamming, 32, FeatureKind::kOrb, "ORB, 256 bits", "bits"},
    {DescriptorKind::kSiftBinary, Metric::kHamming, 32, FeatureKind::kSift, "SIFT, 256 bits by random planes",
     "bits"},
    {DescriptorKind::kSurfBinary, Metric::kHamming, 32, FeatureKind::kSurf, "SURF, 256 bits by random planes",
     "bits"},
    {DescriptorKind::kSift, Metric::kEuclidean, 128, FeatureKind::kSift, "SIFT, 128 bytes", "squared steps"},
    {DescriptorKind::kSurf, Metric::kEuclidean, 64, FeatureKind::kSurf, "SURF, 64 bytes", "squared steps"},
}};

}  // namespace

const DescriptorTraits& descriptor_traits(DescriptorKind kind) {
  const auto found =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& k) { return k.kind == kind; });
  require(found != kKinds.end(), "descriptor_traits: unknown kind of descriptor");
  return *found;
}

std::optional<DescriptorKind> descriptor_kind(uint32_t number) {
  for (const auto& traits : kKinds) {
    if (static_cast<uint32_t>(traits.kind) == number) return traits.kind;
  }
  return std::nullopt;
}

std::optional<DescriptorKind> descriptor_kind(const FeatureOptions& options, Metric metric) {
  for (const auto& traits : kKinds) {
    if (traits.feature == options.kind && traits.metric == metric) return traits.kind;
  }
  return std::nullopt;
}

}  // namespace kinloop
