#include "simulator/render/renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kinloop/core/random.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop::sim {
namespace {

constexpr float kMaxRange_m = 50;  // maximum ray length
constexpr int kMaxPackets = 2;     // of kLanes sub-exposures
constexpr int kTile = 16;          // pixels of a row that share a list of candidates
constexpr int kRowsPerMoment = 8;  // for which what moves stands still: half a millisecond of a Kinect

/// Subpixel positions of the sub-exposures (px from the centre): no two in one row or column.
struct Offset {
  float x, y;
};
constexpr std::array<Offset, kLanes> kFourPlaces{
    {{-0.125F, -0.375F}, {0.375F, -0.125F}, {-0.375F, 0.125F}, {0.125F, 0.375F}}};
constexpr std::array<Offset, 2 * kLanes> kEightPlaces{{{-0.0625F, -0.4375F},
                                                       {0.3125F, -0.3125F},
                                                       {-0.3125F, -0.1875F},
                                                       {0.4375F, -0.0625F},
                                                       {-0.4375F, 0.0625F},
                                                       {0.1875F, 0.1875F},
                                                       {-0.1875F, 0.3125F},
                                                       {0.0625F, 0.4375F}}};

/// Four poses, one per lane, with their subpixel offsets.
struct PosePacket {
  Lanes R[9];
  Lanes3 origin;
  Lanes shift_x, shift_y;  ///< in ray coordinates

  void set(int lane, const SE3& T_room_camera, float x, float y) {
    const Eigen::Matrix3f rotation = T_room_camera.R().cast<float>();
    const Eigen::Vector3f t = T_room_camera.translation.cast<float>();
    for (int i = 0; i < 9; ++i) R[i][lane] = rotation(i / 3, i % 3);
    origin.x[lane] = t.x();
    origin.y[lane] = t.y();
    origin.z[lane] = t.z();
    shift_x[lane] = x;
    shift_y[lane] = y;
  }

  [[nodiscard]] RayPacket rays(Lanes x, Lanes y) const {
    x += shift_x;
    y += shift_y;
    return {origin, {R[0] * x + R[1] * y + R[2], R[3] * x + R[4] * y + R[5], R[6] * x + R[7] * y + R[8]}};
  }
};

}  // namespace

/// What the pixels of a colour image share.
struct Renderer::Exposure {
  float gain;
  uint64_t seed;
};

/// The camera poses during one row.
struct Renderer::RowPoses {
  int packets = 0;
  PosePacket color[kMaxPackets]{};
  PosePacket depth{};
};

/// The rays of neighbouring pixels of a row.
struct Renderer::Tile {
  int row, begin, end, packets;
  RayPacket color[kTile * kMaxPackets];  ///< sub-exposures of each pixel
  RayPacket depth[kTile / kLanes];       ///< four pixels each
  RayBundle bundle;
};

/// What the rays of a tile may hit.
struct Renderer::View {
  const Moment* moment;
  MomentCandidates candidates;

  [[nodiscard]] HitPacket hits(const RayPacket& rays) const {
    return moment->nearest(rays, kMaxRange_m, candidates);
  }
};

Renderer::Renderer(const Scene& scene, const PinholeCamera& camera, const KinectNoise& noise,
                   RenderedImages images, int threads)
    : scene_(&scene),
      camera_(camera),
      noise_(noise),
      with_depth_(images == RenderedImages::kColorAndDepth),
      threads_(threads) {
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d pixel = camera.undistort(Eigen::Vector2d(x, y));
      ray_x_.push_back(static_cast<float>((pixel.x() - camera.cx) / camera.fx));
      ray_y_.push_back(static_cast<float>((pixel.y() - camera.cy) / camera.fy));
    }
  }
}

int64_t Renderer::row_stamp_ns(int64_t stamp_ns, int row) const {
  const double part = camera_.height > 1 ? static_cast<double>(row) / (camera_.height - 1) - 0.5 : 0;
  return stamp_ns + to_ns(part * noise_.rolling_shutter_s);
}

int Renderer::rows_per_moment() const {
  const bool one = scene_->movers().empty() || noise_.rolling_shutter_s == 0;
  return one ? camera_.height : kRowsPerMoment;
}

/// The scene during the readout of an image: one moment for every few rows.
std::vector<Moment> Renderer::moments(int64_t stamp_ns) const {
  const int rows = rows_per_moment();
  std::vector<Moment> all;
  for (int row = 0; row < camera_.height; row += rows) {
    const int middle = row + std::min(rows, camera_.height - row) / 2;
    all.emplace_back(*scene_, row_stamp_ns(stamp_ns, middle));
  }
  return all;
}

/// Four sub-exposures smooth edges and moderate blur; fast motion needs more, or the blur breaks up into
/// separate images.
int Renderer::color_packets(const CameraPath& path, int64_t stamp_ns) const {
  constexpr double kWideBlur_px = 9, kTypicalDepth_m = 1.5;
  const int64_t half_ns = to_ns(noise_.exposure_s / 2);
  const SE3 motion = path.at(stamp_ns - half_ns).inverse() * path.at(stamp_ns + half_ns);
  const double blur_px = camera_.fx * (motion.angle_rad() + motion.translation.norm() / kTypicalDepth_m);
  return blur_px > kWideBlur_px ? kMaxPackets : 1;
}

Renderer::RowPoses Renderer::row_poses(const CameraPath& path, const FrameStamps& row, int packets) const {
  const Offset* places = packets == 1 ? kFourPlaces.data() : kEightPlaces.data();
  const auto inverse_fx = static_cast<float>(1 / camera_.fx), inverse_fy = static_cast<float>(1 / camera_.fy);
  const int count = packets * kLanes;
  RowPoses poses;
  poses.packets = packets;
  for (int i = 0; i < count; ++i) {
    const double when_s = ((i + 0.5) / count - 0.5) * noise_.exposure_s;
    poses.color[i / kLanes].set(i % kLanes, path.at(row.color_ns + to_ns(when_s)), places[i].x * inverse_fx,
                                places[i].y * inverse_fy);
  }
  const SE3 T_room_depth = path.at(row.depth_ns + to_ns(noise_.depth_delay_s));
  for (int lane = 0; lane < kLanes; ++lane) poses.depth.set(lane, T_room_depth, 0, 0);
  return poses;
}

Renderer::Tile Renderer::tile_rays(const RowPoses& poses, int row, int begin) const {
  Tile tile{};
  tile.row = row;
  tile.begin = begin;
  tile.end = std::min(begin + kTile, camera_.width);
  tile.packets = poses.packets;
  const size_t first = static_cast<size_t>(row) * static_cast<size_t>(camera_.width);
  for (int x = begin; x < tile.end; ++x) {
    const size_t pixel = first + static_cast<size_t>(x);
    for (int p = 0; p < poses.packets; ++p) {
      RayPacket& rays = tile.color[(x - begin) * poses.packets + p];
      rays = poses.color[p].rays(all_lanes(ray_x_[pixel]), all_lanes(ray_y_[pixel]));
      tile.bundle.extend(rays);
    }
  }
  for (int x = begin; with_depth_ && x < tile.end; x += kLanes) {
    Lanes ray_x{}, ray_y{};
    for (int lane = 0; lane < kLanes; ++lane) {
      const size_t pixel = first + static_cast<size_t>(std::min(x + lane, camera_.width - 1));
      ray_x[lane] = ray_x_[pixel];
      ray_y[lane] = ray_y_[pixel];
    }
    RayPacket& rays = tile.depth[(x - begin) / kLanes];
    rays = poses.depth.rays(ray_x, ray_y);
    tile.bundle.extend(rays);
  }
  return tile;
}

/// Converts an exposure to the sensor's intensities.
cv::Vec3b Renderer::to_bgr8(Lanes bgr, float gain, uint64_t bits) const {
  const uint32_t draws[3] = {static_cast<uint32_t>(bits), static_cast<uint32_t>(bits >> 32),
                             static_cast<uint32_t>(hash(bits, 2))};
  cv::Vec3b pixel;
  for (int c = 0; c < 3; ++c) {
    float level = std::min(gain * bgr[c], 255.0F);
    if (noise_.image_noise > 0) level = noisy_level(level, noise_, draws[c]);
    pixel[c] = static_cast<uint8_t>(std::clamp(level + 0.5F, 0.0F, 255.0F));
  }
  return pixel;
}

void Renderer::render_color(const Tile& tile, const View& view, const Exposure& exposure,
                            cv::Mat& out) const {
  // The footprints of samples overlap: each covers about half the pixel's width.
  constexpr float kSampleWidth = 0.6F;
  const auto sample_angle = static_cast<float>(kSampleWidth / camera_.fx);
  auto* color = out.ptr<cv::Vec3b>(tile.row);
  for (int x = tile.begin; x < tile.end; ++x) {
    Lanes sum = all_lanes(0);
    for (int p = 0; p < tile.packets; ++p) {
      const RayPacket& rays = tile.color[(x - tile.begin) * tile.packets + p];
      sum += view.moment->mean_color(rays, view.hits(rays), sample_angle);
    }
    const uint64_t bits =
        hash(exposure.seed, static_cast<uint64_t>(tile.row) * static_cast<uint64_t>(camera_.width) +
                                static_cast<uint64_t>(x));
    color[x] = to_bgr8(sum, exposure.gain / static_cast<float>(tile.packets), bits);
  }
}

void Renderer::render_depth(const Tile& tile, const View& view, ExactDepth& out) const {
  auto* depth_m = out.depth_m.ptr<float>(tile.row);
  auto* cosine = out.cosine.ptr<float>(tile.row);
  for (int x = tile.begin; x < tile.end; x += kLanes) {
    const RayPacket& rays = tile.depth[(x - tile.begin) / kLanes];
    const HitPacket hits = view.hits(rays);
    for (int lane = 0; lane < std::min(kLanes, tile.end - x); ++lane) {
      depth_m[x + lane] = hits.t[lane];  // z, since the rays are (x, y, 1) in the camera frame
      if (noise_.holes) cosine[x + lane] = view.moment->infrared_cosine(rays, hits, lane);
    }
  }
}

Frame Renderer::render(const CameraPath& path, const FrameStamps& stamps, uint64_t frame_seed) const {
  const cv::Size size(camera_.width, camera_.height);
  Frame frame;
  frame.stamp_ns = stamps.color_ns;
  frame.depth_stamp_ns = stamps.depth_ns;
  cv::Mat color(size, CV_8UC3);
  ExactDepth exact;
  if (with_depth_) exact = {cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC1, cv::Scalar(1))};
  const int packets = color_packets(path, stamps.color_ns);
  const Exposure exposure{static_cast<float>(gain_at(noise_, to_seconds(stamps.color_ns))),
                          hash(frame_seed, 1)};
  const std::vector<Moment> at_color = moments(stamps.color_ns);
  const std::vector<Moment> at_depth =
      with_depth_ ? moments(stamps.depth_ns + to_ns(noise_.depth_delay_s)) : std::vector<Moment>{};
  parallel_for(static_cast<size_t>(size.height), threads_, [&](size_t begin, size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      const FrameStamps of_row{row_stamp_ns(stamps.color_ns, row), row_stamp_ns(stamps.depth_ns, row)};
      const RowPoses poses = row_poses(path, of_row, packets);
      const auto moment = static_cast<size_t>(row / rows_per_moment());
      for (int x = 0; x < size.width; x += kTile) {
        const Tile tile = tile_rays(poses, row, x);
        View view{&at_color[moment], at_color[moment].candidates(tile.bundle)};
        render_color(tile, view, exposure, color);
        if (!with_depth_) continue;
        view.moment = &at_depth[moment];
        view.candidates.movers = view.moment->mover_candidates(tile.bundle);
        render_depth(tile, view, exact);
      }
    }
  });
  frame.color = color;
  if (with_depth_) frame.depth_m = measured_depth(exact, noise_, hash(frame_seed, 2), threads_);
  return frame;
}

void Renderer::mark_movers(const Tile& tile, const View& view, cv::Mat& out) const {
  constexpr uint8_t kMovingLevel = 255, kRestingLevel = 128;
  auto* mask = out.ptr<uint8_t>(tile.row);
  for (int ray = 0; ray < (tile.end - tile.begin) * tile.packets; ++ray) {
    uint8_t& pixel = mask[tile.begin + ray / tile.packets];
    const HitPacket hits = view.hits(tile.color[ray]);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Motion motion = view.moment->motion_of(hits.primitive[lane]);
      if (motion == Motion::kMoving) pixel = kMovingLevel;
      if (motion == Motion::kAtRest) pixel = std::max(pixel, kRestingLevel);
    }
  }
}

cv::Mat Renderer::mover_mask(const CameraPath& path, const FrameStamps& stamps) const {
  cv::Mat mask = cv::Mat::zeros(camera_.height, camera_.width, CV_8UC1);
  const int packets = color_packets(path, stamps.color_ns);
  const std::vector<Moment> at_color = moments(stamps.color_ns);
  parallel_for(static_cast<size_t>(mask.rows), threads_, [&](size_t begin, size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      const FrameStamps of_row{row_stamp_ns(stamps.color_ns, row), row_stamp_ns(stamps.depth_ns, row)};
      const RowPoses poses = row_poses(path, of_row, packets);
      const Moment& moment = at_color[static_cast<size_t>(row / rows_per_moment())];
      for (int x = 0; x < mask.cols; x += kTile) {
        const Tile tile = tile_rays(poses, row, x);
        const View view{&moment, moment.candidates(tile.bundle)};
        if (!view.candidates.movers.empty()) mark_movers(tile, view, mask);
      }
    }
  });
  return mask;
}

}  // namespace kinloop::sim
