#pragma once
// In: "sim:room" or "sim:room:SEED", optionally a recorded path. Out: the frames of an RGB-D camera on that
// path through a furnished room, with ground truth. Time: the stamp of a frame is the middle of the exposure
// of the middle row of its colour image, and the ground truth is the pose of the colour camera at that
// moment. Depth is measured `noise.depth_delay_s` after its own stamp, which differs from that of colour by a
// few milliseconds (`noise.depth_stamps`). Depth is registered to the (distorted) colour image, z along the
// colour camera's optical axis. It is rounded to the units of a depth file, that of a depth camera of its own
// before it is registered, so that a written sequence reads back identically.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "kinloop/sensor/source/frame_source.hpp"
#include "kinloop/sensor/source/passable_source.hpp"
#include "simulator/movers/mover_options.hpp"
#include "simulator/sensors/depth_camera.hpp"
#include "simulator/sensors/depth_stamps.hpp"
#include "simulator/sensors/kinect_model.hpp"

namespace kinloop {

struct SimulationOptions {
  SimulatedSensor sensor = SimulatedSensor::kKinect1;
  double fps = 0;
  int frames = 0;
  double seconds = 0;
  bool spacious = false;
  bool corridor = false;
  int floor = 0;
  int width = 0;
  int height = 0;
  bool lens_distortion = true;
  KinectNoise noise;  ///< of colour and time of all sensors, of depth of a Kinect 1
  TimeOfFlightNoise tof;
  StereoNoise stereo;
  MoverOptions movers;

  /// Makes all sensors ideal.
  void remove_noise();

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("sensor", self.sensor, "depth sensor and its cameras");
    visit("fps", self.fps, "frames per second, 0 = the timestamps of the given path, else 30", Range{0, 240});
    visit("frames", self.frames, "number of frames, 0 = the whole path", Range{0, 10'000'000});
    visit("seconds", self.seconds, "duration of the built-in path, which goes round and round, s, 0 = 18.7",
          Range{0, 3600});
    visit("spacious", self.spacious,
          "a larger room with little but chairs and boxes away from the walls; always so with "
          "movers.people or movers.chairs");
    visit("corridor", self.corridor,
          "a corridor with the same doors and notice boards every 4 m, there and back; nothing moves in it");
    visit("floor", self.floor,
          "rooms of one seed on the floors 1, 2, ... have the same furniture and differ in their pictures",
          Range{0, 1000});
    visit("width", self.width,
          "width of the colour image in px, 0 = that of the sensor; depth is scaled in proportion",
          Range{0, 4096});
    visit("height", self.height, "height of the colour image in px, 0 = that of the sensor", Range{0, 4096});
    visit("lens_distortion", self.lens_distortion, "use the lens distortion of the sensor's cameras");
    visit("noise", self.noise);
    visit("tof", self.tof);
    visit("stereo", self.stereo);
    visit("movers", self.movers);
  }
};

/// Sensor parameters that kinloop has to estimate; not part of camera(), since no real camera reports them.
struct SensorGroundTruth {
  double rolling_shutter_s = 0;
  double depth_delay_s = 0;  ///< time of depth minus its stamp
};

/// Renders a room on the fly.
class SimulatedSource : public FrameSource, public PassableSource {
 public:
  /// The room of `seed` along the built-in path, or along `path` (in its stamps and world).
  SimulatedSource(std::string name, uint64_t seed, const SimulationOptions& options, int threads,
                  std::optional<Trajectory> path = {});
  ~SimulatedSource() override;
  SimulatedSource(const SimulatedSource&) = delete;
  SimulatedSource& operator=(const SimulatedSource&) = delete;

  std::optional<Frame> next() override;
  bool pass_over() override;
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override { return {}; }

  /// Returns frame `index` without advancing.
  [[nodiscard]] Frame frame(size_t index) const;

  /// Returns the cameras of the device: with a depth camera if its depth is not registered to colour.
  [[nodiscard]] const RgbdCamera& device() const { return device_; }

  /// Returns frame `index` as the device delivers it: depth is that of `device().depth`, if any.
  [[nodiscard]] Frame device_frame(size_t index) const;

  /// Returns whether anything moves besides the camera.
  [[nodiscard]] bool has_movers() const;

  /// Returns where the colour image of a frame shows what moves, 8UC1: 255 = moving, 128 = at rest at that
  /// time (a door, a chair), 0 = neither.
  [[nodiscard]] cv::Mat mover_mask(size_t index) const;

  [[nodiscard]] const SensorGroundTruth& truth() const { return truth_; }

  /// Returns the unsigned distance from a point in the ground truth's world to the nearest surface that does
  /// not move.
  [[nodiscard]] double distance_to_surface(const Eigen::Vector3d& p_world) const;

 private:
  struct RenderSetup;  ///< room, path and renderers

  RgbdCamera device_, camera_;
  SourceInfo info_;
  SensorGroundTruth truth_;
  uint64_t seed_;
  std::unique_ptr<const RenderSetup> setup_;
  std::vector<sim::FrameStamps> stamps_;  ///< of every frame
  size_t next_ = 0;
};

/// Opens "sim:room" or "sim:room:SEED". Throws UsageError for any other text.
std::unique_ptr<SimulatedSource> make_simulated_source(
    const std::string& spec, const SimulationOptions& options, int threads,
    const std::optional<std::filesystem::path>& path_file = {});

}  // namespace kinloop
