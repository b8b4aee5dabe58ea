#pragma once
// In: a folder of images whose camera nobody knows. Out: the focal length that maps of its first frames fit.
// Depth gives the size of what is seen, and parallax gives it again through the focal length.

#include <optional>
#include <string>

#include "drivers/datasets/camera_files/camera_description.hpp"

namespace kinloop {

/// A camera with the principal point in the middle and without distortion.
struct GuessedCamera {
  CameraDescription description;
  double sigma = 0;         ///< standard deviation of the focal length, as a share of it; 0: not estimated
  int rounds = 0;           ///< maps that were made
  bool is_certain = false;  ///< the last map confirmed its focal length
};

/// Begins with the focal length of a common sensor of the aspect of the images, and corrects it by a map of
/// the first frames until it fits. The arguments are as for open_sequence. Throws InputError if there is no
/// sequence of images.
GuessedCamera guess_camera(const std::string& path, std::optional<double> depth_scale,
                           const std::string& name = {});

/// The same, and says in an info line, or a warning if it is not certain, what was found.
CameraDescription guess_camera_aloud(const std::string& path, std::optional<double> depth_scale,
                                     const std::string& name = {});

}  // namespace kinloop
