#pragma once
// In: depth images whose unit nobody states. Out: the unit that makes their depth that of a room.

#include <optional>

#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

/// A guessed unit of depth, and the median depth that it gives.
struct DepthUnit {
  double depth_scale = 0;  ///< units per metre
  double median_m = 0;
};

/// Returns whether depth images hold floats in metres, as EXR and .npy files do. A median over 100 m is of
/// another unit.
bool has_floats_in_metres(const RecordedSequence& sequence);

/// Guesses the unit from the values of a few images spread over the sequence. Values that are all multiples
/// of 5 are millimetres written in 1/5000 m, as the TUM benchmark does. Returns nullopt if depth is not in
/// images of integers or floats, or no usual unit is plausible.
std::optional<DepthUnit> guess_depth_unit(const RecordedSequence& sequence);

}  // namespace kinloop
