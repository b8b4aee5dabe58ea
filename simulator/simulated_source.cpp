#include "simulator/simulated_source.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/camera/registration.hpp"
#include "simulator/render/renderer.hpp"
#include "simulator/room/room.hpp"

namespace kinloop {
namespace {

constexpr double kDefaultFps = 30;
constexpr uint64_t kDefaultSeed = 1;

/// The camera with an image of another size.
void resize(PinholeCamera& c, double sx, double sy) {
  if (sx == 1 && sy == 1) return;  // exactly
  c = {static_cast<int>(std::lround(sx * c.width)),
       static_cast<int>(std::lround(sy * c.height)),
       sx * c.fx,
       sy * c.fy,
       sx * (c.cx + 0.5) - 0.5,
       sy * (c.cy + 0.5) - 0.5,
       c.lens};
}

RgbdCamera simulated_camera(const SimulationOptions& options) {
  constexpr int kMinSize_px = 16;
  RgbdCamera camera = sim::sensor_camera(options.sensor);
  const int width = options.width > 0 ? options.width : camera.color.width;
  const int height = options.height > 0 ? options.height : camera.color.height;
  if (std::min(width, height) < kMinSize_px) {
    throw UsageError(fmt::format("sim.width, sim.height: {} x {} is too small; expected at least {} x {}",
                                 width, height, kMinSize_px, kMinSize_px));
  }
  const double sx = static_cast<double>(width) / camera.color.width;
  const double sy = static_cast<double>(height) / camera.color.height;
  resize(camera.color, sx, sy);
  if (camera.depth) resize(*camera.depth, sx, sy);
  if (!options.lens_distortion) camera.color.lens = {};
  if (!options.lens_distortion && camera.depth) camera.depth->lens = {};
  if (options.fps > 0) camera.fps = options.fps;
  return camera;
}

/// Rounds to the steps of a depth image, exactly as writing and reading a file would.
cv::Mat as_stored(const cv::Mat& depth_m, double depth_scale) {
  cv::Mat units, stored_m;
  depth_m.convertTo(units, CV_16UC1, depth_scale);
  units.convertTo(stored_m, CV_32FC1, 1.0 / depth_scale);
  return stored_m;
}

/// Stamps of the frames to render, from the times of the colour images.
std::vector<sim::FrameStamps> stamps_to_render(const SimulationOptions& options,
                                               const std::vector<int64_t>& color_ns, uint64_t seed) {
  std::vector<sim::FrameStamps> stamps;
  if (options.noise.depth_stamps) {
    stamps = sim::with_depth_stamps(color_ns, seed);
  } else {
    for (const int64_t stamp_ns : color_ns) stamps.push_back({stamp_ns, stamp_ns});
  }
  const auto wanted = static_cast<size_t>(options.frames);
  if (wanted > 0 && wanted < stamps.size()) stamps.resize(wanted);
  return stamps;
}

uint64_t parse_seed(const std::string& spec, const std::string& text) {
  uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw UsageError(
        fmt::format("'{}': '{}' is not a seed; expected a whole number, e.g. sim:room:7", spec, text));
  }
  return seed;
}

sim::RoomRequest room_request(const SimulationOptions& options, uint64_t seed) {
  if (options.corridor && options.movers.any())
    throw UsageError("sim.corridor, sim.movers: nothing moves in a corridor; leave one of them out");
  return {seed, options.spacious, options.movers, options.corridor, static_cast<uint64_t>(options.floor)};
}

/// The built-in path of the scene.
Trajectory built_in_path(const SimulationOptions& options, uint64_t seed) {
  return options.corridor ? sim::corridor_path(seed, options.seconds)
                          : sim::handheld_path(seed, options.seconds);
}

}  // namespace

struct SimulatedSource::RenderSetup {
  RenderSetup(const Trajectory& path, const RgbdCamera& device, const SimulationOptions& options,
              uint64_t seed, int threads)
      : room(sim::build_room(path, room_request(options, seed), threads)),
        path_in_room(sim::in_room_frame(path, room.T_world_room.inverse())),
        renderer(*room.scene, device.color, options.noise,
                 device.depth ? sim::RenderedImages::kColor : sim::RenderedImages::kColorAndDepth, threads) {
    if (!device.depth) return;
    depth_camera.emplace(*room.scene, device, sim::DepthCameraNoise{options.tof, options.stereo}, threads);
    registration.emplace(device);
  }

  sim::Room room;
  sim::CameraPath path_in_room;
  sim::Renderer renderer;
  std::optional<sim::DepthCamera> depth_camera;  ///< if depth has a camera of its own
  std::optional<DepthRegistration> registration;
};

void SimulationOptions::remove_noise() {
  noise = KinectNoise::none();
  tof = TimeOfFlightNoise::none();
  stereo = StereoNoise::none();
}

SimulatedSource::SimulatedSource(std::string name, uint64_t seed, const SimulationOptions& options,
                                 int threads, std::optional<Trajectory> path)
    : device_(simulated_camera(options)),
      camera_(device_.depth ? registered(device_) : device_),
      seed_(seed) {
  validate(options, "sim.");
  const bool own_path = !path.has_value();
  if (own_path) path = built_in_path(options, seed);
  if (options.noise.rolling_shutter_s == 0) camera_.rolling_shutter_s = 0;  // as a data sheet says
  truth_ = {options.noise.rolling_shutter_s, options.noise.depth_delay_s};
  stamps_ = stamps_to_render(
      options, sim::frame_stamps(*path, own_path && options.fps <= 0 ? kDefaultFps : options.fps), seed);
  setup_ = std::make_unique<const RenderSetup>(*path, device_, options, seed, threads);
  info_.name = std::move(name);
  info_.frames = stamps_.size();
  for (const auto& [color_ns, depth_ns] : stamps_) {
    info_.ground_truth.push_back({color_ns, setup_->room.T_world_room * setup_->path_in_room.at(color_ns)});
  }
}

SimulatedSource::~SimulatedSource() = default;

Frame SimulatedSource::device_frame(size_t index) const {
  require(index < info_.frames, "a frame of the simulated sequence");
  const uint64_t seed = hash(seed_, index);
  Frame frame = setup_->renderer.render(setup_->path_in_room, stamps_[index], seed);
  frame.id = FrameId{static_cast<uint32_t>(index)};
  if (setup_->depth_camera) {
    const int64_t depth_ns = stamps_[index].depth_ns + to_ns(truth_.depth_delay_s);
    frame.depth_m = setup_->depth_camera->measure(setup_->path_in_room.at(depth_ns), depth_ns, hash(seed, 2));
  }
  frame.depth_m = as_stored(frame.depth_m, device_.depth_scale);
  return frame;
}

bool SimulatedSource::has_movers() const {
  return !setup_->room.scene->movers().empty();
}

cv::Mat SimulatedSource::mover_mask(size_t index) const {
  require(index < info_.frames, "a frame of the simulated sequence");
  return setup_->renderer.mover_mask(setup_->path_in_room, stamps_[index]);
}

Frame SimulatedSource::frame(size_t index) const {
  Frame frame = device_frame(index);
  if (setup_->registration) frame.depth_m = (*setup_->registration)(frame.depth_m);
  return frame;
}

std::optional<Frame> SimulatedSource::next() {
  if (next_ == info_.frames) return std::nullopt;
  return frame(next_++);
}

bool SimulatedSource::pass_over() {
  if (next_ == info_.frames) return false;
  ++next_;
  return true;
}

double SimulatedSource::distance_to_surface(const Eigen::Vector3d& p_world) const {
  return setup_->room.scene->distance_to_surface(setup_->room.T_world_room.inverse() * p_world);
}

std::unique_ptr<SimulatedSource> make_simulated_source(
    const std::string& spec, const SimulationOptions& options, int threads,
    const std::optional<std::filesystem::path>& path_file) {
  const std::string kRoom = "sim:room";
  uint64_t seed = kDefaultSeed;
  if (spec.starts_with(kRoom + ":")) {
    seed = parse_seed(spec, spec.substr(kRoom.size() + 1));
  } else if (spec != kRoom) {
    throw UsageError(fmt::format("'{}' is not a simulated scene; expected sim:room or sim:room:SEED", spec));
  }
  std::optional<Trajectory> path;
  if (path_file) {
    path = read_tum_trajectory(*path_file);
    if (path->empty())
      throw InputError(fmt::format("{}: contains no pose; expected lines 'timestamp tx ty tz qx qy qz qw'",
                                   path_file->string()));
  }
  return std::make_unique<SimulatedSource>(spec, seed, options, threads, std::move(path));
}

}  // namespace kinloop
