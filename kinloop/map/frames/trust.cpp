#include "kinloop/map/frames/trust.hpp"

#include <array>

namespace kinloop {
namespace {

constexpr std::array<std::string_view, 16> kNames = {
    "-",     "unknown", "surfaces", "moving",       "few_landmarks", "hidden",     "drift", "scale",
    "place", "frozen",  "no_depth", "fixed_region", "withdrawn",     "unmeasured", "jump",  "neighbours"};

}  // namespace

std::string_view name_of(DoubtCause cause) {
  return kNames.at(static_cast<size_t>(cause));
}

std::optional<DoubtCause> doubt_cause(int64_t number) {
  if (number < 0 || number >= static_cast<int64_t>(kNames.size())) return std::nullopt;
  return static_cast<DoubtCause>(number);
}

}  // namespace kinloop
