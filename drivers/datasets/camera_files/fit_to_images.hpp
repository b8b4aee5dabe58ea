#pragma once
// In: what a camera file states, and images. Out: their camera. What is not stated is taken from the images,
// and said.

#include <optional>

#include <opencv2/core/types.hpp>

#include "drivers/datasets/camera_files/camera_description.hpp"
#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

// In: depth images whose unit nobody states. Out: the unit that makes their depth that of a room.

/// A guessed unit of depth, and the median depth that it gives.
struct DepthUnit {
  double depth_scale = 0;  ///< units per metre
  double median_m = 0;
  int divisor = 1;  ///< of nearly all values; more than 1 where whole millimetres were multiplied by it

  /// Another usual unit that would be plausible, and the median that it would give; 0: there is none.
  double other_scale = 0, other_median_m = 0;
};

/// Returns whether depth images hold floats in metres, as EXR and .npy files do. A median over 100 m is of
/// another unit.
bool has_floats_in_metres(const RecordedSequence& sequence);

/// Guesses the unit from the values of a few images spread over the sequence. Sensors measure in whole
/// millimetres: values that are all multiples of 5 are in 1/5000 m, as in the TUM benchmark, multiples of 10
/// in 1/10000 m. Returns nullopt if depth is not in images of integers or floats, or no usual unit is
/// plausible.
std::optional<DepthUnit> guess_depth_unit(const RecordedSequence& sequence);

/// Returns the camera of the images of a sequence, and says in an info line where it is from. A size that is
/// not stated is that of the images; intrinsics of another size with the same aspect are scaled. A unit of
/// depth that is not stated is guessed, and `depth_unit_guess` set. `depth_scale` replaces any. Throws
/// InputError naming the source if it cannot be the camera of these images, or the unit of depth cannot be
/// told.
RgbdCamera fit_to_images(const CameraDescription& description, RecordedSequence& sequence,
                         std::optional<double> depth_scale = {});

/// Gives depth of another size but the aspect of colour its own lens, that of colour scaled: the same view at
/// another resolution, as phones have it. Returns the size of depth; nullopt if the camera stays as it is.
std::optional<cv::Size> fit_depth_size(const RecordedSequence& sequence, RgbdCamera& camera);

/// Returns the camera of a source that states the unit of its depth, such as a bag. Throws InputError if the
/// size of the images is not stated.
RgbdCamera camera_without_images(const CameraDescription& description);

}  // namespace kinloop
