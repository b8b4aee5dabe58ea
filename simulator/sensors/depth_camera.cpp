#include "simulator/sensors/depth_camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/sensor/camera/camera_presets.hpp"
#include "simulator/sensors/depth_models.hpp"

namespace kinloop::sim {

namespace {

constexpr std::array kKinect2Lens{0.0905, -0.268, 0.0, 0.0, 0.0951};  // k1 k2 p1 p2 k3

RgbdCamera kinect2() {
  RgbdCamera camera;
  camera.color = {960, 540, 540.7, 540.7, 479.5, 269.5, {}};
  camera.depth =
      PinholeCamera{512, 424, 365.5, 365.5, 255.1, 206.8, lens_with(LensModel::kBrownConrady, kKinect2Lens)};
  camera.T_color_depth = {exp_so3({0.003, -0.005, 0.002}), {-0.052, 0.0005, 0.001}};
  camera.sensor = depth_sensor(DepthSensorModel::kKinect2, SensorOrigin::kSource);
  return camera;
}

RgbdCamera realsense() {
  RgbdCamera camera;
  camera.color = {640, 480, 615, 615, 319.5, 239.5, {}};
  camera.depth = PinholeCamera{848, 480, 424, 424, 423.5, 239.5, {}};
  camera.T_color_depth = {exp_so3({-0.002, 0.003, 0.001}), {0.0147, 0.0001, 0.0003}};
  camera.depth_scale = 1000;
  camera.sensor = depth_sensor(DepthSensorModel::kRealsenseD4xx, SensorOrigin::kSource);
  return camera;
}

}  // namespace

RgbdCamera sensor_camera(SimulatedSensor sensor) {
  if (sensor == SimulatedSensor::kKinect2) return kinect2();
  return sensor == SimulatedSensor::kRealsense ? realsense() : camera_preset("freiburg1").value();
}

namespace {

constexpr float kMaxDepth_m = 50;  // maximum ray length
constexpr size_t kTileRays = 64;   // of a row, which share a list of candidates

/// Positions of the samples within a pixel (px from the centre): no two in one row or column.
constexpr double kSampleX[kLanes] = {-0.125, 0.375, -0.375, 0.125},
                 kSampleY[kLanes] = {-0.375, -0.125, 0.125, 0.375};

}  // namespace

/// Neighbouring rays of a row.
struct DepthRenderer::Tile {
  RayPacket rays[kTileRays / kLanes];
  RayBundle bundle;
};

/// Where the results of neighbouring rays go.
struct DepthRenderer::Row {
  float *depth_m, *cosine, *reflectance;
};

DepthRenderer::DepthRenderer(const PinholeCamera& camera, SamplesPerPixel samples, int threads)
    : camera_(camera),
      samples_(static_cast<int>(samples)),
      threads_(threads),
      range_per_depth_(camera.height, camera.width, CV_32FC1) {
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) add_rays({x, y});
  }
}

void DepthRenderer::add_rays(const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d center = camera_.undistort(pixel);
  const Eigen::Vector3d ray = camera_.unproject(center, 1);
  range_per_depth_.at<float>(static_cast<int>(pixel.y()), static_cast<int>(pixel.x())) =
      static_cast<float>(ray.norm());
  for (int i = 0; i < samples_; ++i) {
    const Eigen::Vector2d shift =
        samples_ == 1 ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(kSampleX[i], kSampleY[i]);
    ray_x_.push_back(static_cast<float>(ray.x() + shift.x() / camera_.fx));
    ray_y_.push_back(static_cast<float>(ray.y() + shift.y() / camera_.fy));
  }
}

/// `count` rays from `first` on; the last packet is filled by repeating the last.
DepthRenderer::Tile DepthRenderer::tile_rays(const SE3& T_room_camera, size_t first, size_t count) const {
  const Eigen::Matrix3f R = T_room_camera.R().cast<float>();
  const Eigen::Vector3f t = T_room_camera.translation.cast<float>();
  Tile tile{};
  for (size_t i = 0; i < count; i += kLanes) {
    Lanes x{}, y{};
    for (int lane = 0; lane < kLanes; ++lane) {
      const size_t ray = first + std::min(i + static_cast<size_t>(lane), count - 1);
      x[lane] = ray_x_[ray];
      y[lane] = ray_y_[ray];
    }
    RayPacket& rays = tile.rays[i / kLanes];
    rays = {{all_lanes(t.x()), all_lanes(t.y()), all_lanes(t.z())},
            {R(0, 0) * x + R(0, 1) * y + R(0, 2), R(1, 0) * x + R(1, 1) * y + R(1, 2),
             R(2, 0) * x + R(2, 1) * y + R(2, 2)}};
    tile.bundle.extend(rays);
  }
  return tile;
}

void DepthRenderer::render_tile(const Moment& moment, const Tile& tile, size_t count, const Row& out) const {
  const auto sample_angle = static_cast<float>(1 / (camera_.fx * std::sqrt(samples_)));
  const MomentCandidates candidates = moment.candidates(tile.bundle);
  for (size_t first = 0; first < count; first += kLanes) {
    const RayPacket& rays = tile.rays[first / kLanes];
    const HitPacket hits = moment.nearest(rays, kMaxDepth_m, candidates);
    for (int lane = 0; lane < kLanes && first + static_cast<size_t>(lane) < count; ++lane) {
      const size_t i = first + static_cast<size_t>(lane);
      out.depth_m[i] = hits.t[lane];  // z, since the rays are (x, y, 1) in the camera frame
      out.cosine[i] = moment.infrared_cosine(rays, hits, lane);
      out.reflectance[i] = moment.infrared_reflectance(rays, hits, lane, sample_angle);
    }
  }
}

ExactDepth DepthRenderer::render(const Moment& moment, const SE3& T_room_camera) const {
  const cv::Size size(camera_.width, camera_.height);
  const int type = CV_32FC(samples_);
  ExactDepth exact{cv::Mat(size, type), cv::Mat(size, type), cv::Mat(size, type)};
  const size_t width = static_cast<size_t>(size.width) * static_cast<size_t>(samples_);
  parallel_for(static_cast<size_t>(size.height), threads_, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row);
      const Row out{exact.depth_m.ptr<float>(y), exact.cosine.ptr<float>(y), exact.reflectance.ptr<float>(y)};
      for (size_t x = 0; x < width; x += kTileRays) {
        const size_t count = std::min(kTileRays, width - x);
        render_tile(moment, tile_rays(T_room_camera, row * width + x, count), count,
                    {out.depth_m + x, out.cosine + x, out.reflectance + x});
      }
    }
  });
  return exact;
}

namespace {

SamplesPerPixel samples(const RgbdCamera& camera, const DepthCameraNoise& noise) {
  const bool mixed = camera.sensor.kind == DepthSensorKind::kTimeOfFlight && noise.tof.flying_pixels;
  return mixed ? SamplesPerPixel::kFour : SamplesPerPixel::kOne;
}

}  // namespace

DepthCamera::DepthCamera(const Scene& scene, const RgbdCamera& camera, const DepthCameraNoise& noise,
                         int threads)
    : scene_(&scene),
      camera_(camera.depth.value()),
      T_color_depth_(camera.T_color_depth),
      kind_(camera.sensor.kind),
      noise_(noise),
      threads_(threads),
      renderer_(camera_, samples(camera, noise), threads) {}

cv::Mat DepthCamera::measure(const SE3& T_room_color, int64_t stamp_ns, uint64_t seed) const {
  const Moment moment(*scene_, stamp_ns);
  const SE3 T_room_depth = T_room_color * T_color_depth_;
  const ExactDepth exact = renderer_.render(moment, T_room_depth);
  if (kind_ == DepthSensorKind::kStereo)
    return matched_depth(exact, camera_.fx * kStereoBaseline_m, noise_.stereo, seed, threads_);
  TimeOfFlightRays view{exact, renderer_.range_per_depth(), {}};
  if (noise_.tof.multipath) view.range_error_m = multipath_error_m(moment, camera_, T_room_depth, threads_);
  return measured_depth(view, noise_.tof, seed, threads_);
}

}  // namespace kinloop::sim
