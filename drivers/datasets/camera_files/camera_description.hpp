#pragma once
// What a camera file of another program states. Few of them state all that a camera.yaml has: the size of the
// images and the unit of depth are often left to the reader.

#include <span>
#include <string>

#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

struct CameraDescription {
  std::string source;  ///< the file or the option, as named in messages
  std::string format;  ///< for users: "COLMAP cameras.txt"
  RgbdCamera camera;   ///< what is not stated has its default; width and height are 0
  bool has_depth_scale = false;
  bool has_fps = false;
  bool is_complete = false;  ///< of a camera.yaml, which states everything: used as it is

  [[nodiscard]] bool has_size() const { return camera.color.width > 0; }
};

enum class DistortionModel { kOpenCv, kFisheye };

/// Sets fx, fy, cx, cy. Throws InputError naming the source unless they are finite and the focal lengths
/// positive.
void set_intrinsics(CameraDescription& description, double fx, double fy, double cx, double cy);

/// Sets the size of the images. Throws InputError naming the source unless images can have it.
void set_size(CameraDescription& description, double width, double height);

/// Sets the distortion of OpenCV's coefficients: up to 5 (k1 k2 p1 p2 k3), 8 of the rational model, or 12 or
/// 14 whose further ones are zero; 4 of a fisheye lens. Throws InputError naming the source for others.
void set_distortion(CameraDescription& description, std::span<const double> coefficients,
                    DistortionModel model = DistortionModel::kOpenCv);

/// Sets the unit of depth from a factor that some files give in units per metre (5000) and others in metres
/// per unit (0.001). A factor near 1 may mean either, and is not used.
void set_depth_scale(CameraDescription& description, double factor);

/// Sets the frame rate if it is possible.
void set_fps(CameraDescription& description, double fps);

/// Returns whether two descriptions agree in all that both of them state. Distortion that only one of them
/// has is no contradiction.
bool agree(const CameraDescription& a, const CameraDescription& b);

}  // namespace kinloop
