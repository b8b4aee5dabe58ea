#pragma once
// In: a sequence without a camera. Out: a camera.yaml to be corrected by the user.

#include <string>

#include "drivers/datasets/camera_files/camera_description.hpp"
#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

/// Returns the text of a camera.yaml with the size of the images, the unit of depth guessed from their
/// values, and the focal length of a common sensor of that aspect; what is a guess is marked as one. A
/// sequence without readable images gives the template of a Kinect.
std::string camera_template(const RecordedSequence& sequence);

/// Returns the camera of that template, for images of any known size. Throws InputError if none is readable.
CameraDescription common_camera(const RecordedSequence& sequence);

}  // namespace kinloop
