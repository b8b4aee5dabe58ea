#pragma once
// A map with everything needed to continue it, as a map file holds it.

#include <string>
#include <utility>
#include <vector>

#include "kinloop/map/frames/frame_record.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// A run that created or continued the map.
struct SavedSession {
  std::string input;    ///< as given by the user
  FrameId first_frame;  ///< the session extends to the first frame of the next one
};

/// One self-calibrated sensor parameter.
struct SavedParameter {
  double value = 0;
  double sigma = 0;
  bool used = false;
};

/// The whole map except its images.
struct SavedMap {
  std::string program;  ///< version of the program that wrote it
  std::vector<SavedSession> sessions;
  std::vector<std::pair<std::string, std::string>> options;  ///< options of the latest run, key and value
  RgbdCamera camera;
  std::vector<SavedParameter> sensor;
  MapData map;
  std::vector<FrameRecord> frames;
};

}  // namespace kinloop
