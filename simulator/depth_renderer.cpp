#include "simulator/depth_renderer.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop::sim {
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

DepthRenderer::DepthRenderer(const Scene& scene, const PinholeCamera& camera, SamplesPerPixel samples,
                             int threads)
    : scene_(&scene),
      camera_(camera),
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

void DepthRenderer::render_tile(const Tile& tile, size_t count, const Row& out) const {
  const auto sample_angle = static_cast<float>(1 / (camera_.fx * std::sqrt(samples_)));
  const std::vector<Candidate> candidates = scene_->bvh().candidates(tile.bundle);
  for (size_t first = 0; first < count; first += kLanes) {
    const RayPacket& rays = tile.rays[first / kLanes];
    const HitPacket hits = scene_->bvh().nearest(rays, kMaxDepth_m, candidates);
    for (int lane = 0; lane < kLanes && first + static_cast<size_t>(lane) < count; ++lane) {
      const size_t i = first + static_cast<size_t>(lane);
      out.depth_m[i] = hits.t[lane];  // z, since the rays are (x, y, 1) in the camera frame
      out.cosine[i] = scene_->infrared_cosine(rays, hits, lane);
      out.reflectance[i] = scene_->infrared_reflectance(rays, hits, lane, sample_angle);
    }
  }
}

ExactDepth DepthRenderer::render(const SE3& T_room_camera) const {
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
        render_tile(tile_rays(T_room_camera, row * width + x, count), count,
                    {out.depth_m + x, out.cosine + x, out.reflectance + x});
      }
    }
  });
  return exact;
}

}  // namespace kinloop::sim
