#include "dense/live_mesh/live_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace kinloop {
namespace {

/// As for meshes made afterwards, see MeshOptions.
constexpr double kTruncation_voxels = 4;

/// Number of keyframes that a submap takes new surface from.
constexpr uint32_t kKeyframesPerSubmap = 8;

/// A view agrees with a submap that knows so many of its samples, if most of these are at a surface.
constexpr size_t kMinKnown = 10;
constexpr double kMinAgreeing = 0.6;

/// So many samples tell whether a view agrees.
constexpr size_t kAgreementSamples = 1000;

/// Less new surface, as a share of the samples, is no reason to begin a submap.
constexpr double kMinNew = 0.01;

constexpr uint32_t kNoPiece = ~uint32_t{0};

/// Pixels between samples: adjacent ones are in the same block or in neighbours at the greatest depth.
int sample_stride_px(const PinholeCamera& camera, const LiveMeshOptions& options) {
  const double block_px =
      kTsdfBlockEdge * options.voxel_m * std::min(camera.fx, camera.fy) / options.limits.max_depth_m;
  return std::clamp(static_cast<int>(block_px / std::sqrt(2.0)), 2, 16);
}

std::vector<Eigen::Vector3f> moved(std::span<const Eigen::Vector3f> points, const SE3& T) {
  const Eigen::Matrix3f R = T.R().cast<float>();
  const Eigen::Vector3f t = T.translation.cast<float>();
  std::vector<Eigen::Vector3f> result;
  result.reserve(points.size());
  for (const Eigen::Vector3f& p : points) result.emplace_back(R * p + t);
  return result;
}

/// Every n-th of them, so that there are at most `most`.
std::vector<Eigen::Vector3f> thinned(std::span<const Eigen::Vector3f> points, size_t most) {
  const size_t step = points.size() / most + 1;
  std::vector<Eigen::Vector3f> kept;
  for (size_t i = 0; i < points.size(); i += step) kept.push_back(points[i]);
  return kept;
}

}  // namespace

LiveMesh::LiveMesh(const LiveMeshOptions& options)
    : options_(options), scale_{options.voxel_m, kTruncation_voxels * options.voxel_m} {}

void LiveMesh::correct(std::span<const SE3> T_world_keyframe) {
  T_world_keyframe_.assign(T_world_keyframe.begin(), T_world_keyframe.end());
}

void LiveMesh::fuse(FusionView view, KeyframeId keyframe, const SE3& T_keyframe_camera) {
  ++views_;
  const SE3 T_world_camera = T_world_keyframe_[keyframe.value] * T_keyframe_camera;
  const auto samples = sampled_surface(view, sample_stride_px(view.camera.color, options_));
  std::vector<size_t> parts = agreeing_parts(samples, T_world_camera);
  // Exposure changes slowly: where a view shows too little that is known, it is that of the last one.
  gain_ = view_gain(color_pairs(view, samples, T_world_camera, parts)).value_or(gain_);
  view.color_gain = gain_;
  std::vector<WantedBlock> blocks = wanted_blocks(samples, T_world_camera, keyframe, parts);
  link(parts);
  for (const size_t i : parts) parts_[i].last_view = views_;
  allocate(std::move(blocks));
  const DepthTiles tiles(view.depth_m);
  for (const size_t i : parts) parts_[i].submap.fuse(view, tiles, T_world_camera.inverse() * pose(parts_[i]));
}

/// Returns the colours of some samples in the view and in the first of the parts that knows them.
std::vector<ColorPair> LiveMesh::color_pairs(const FusionView& view, std::span<const Eigen::Vector3f> samples,
                                             const SE3& T_world_camera, std::span<const size_t> parts) const {
  std::vector<Eigen::Vector3f> left = thinned(samples, kAgreementSamples);
  std::vector<ColorPair> pairs;
  for (const size_t i : parts) {
    const SE3 T_part_camera = pose(parts_[i]).inverse() * T_world_camera;
    const Submap& submap = parts_[i].submap;
    std::erase_if(left, [&](const Eigen::Vector3f& p_camera) {
      const auto in_mesh = submap.color_at((T_part_camera * p_camera.cast<double>()).cast<float>());
      if (!in_mesh) return false;
      if (const auto in_view = color_at(view, p_camera)) pairs.push_back({*in_view, *in_mesh});
      return true;
    });
  }
  return pairs;
}

std::vector<size_t> LiveMesh::agreeing_parts(std::span<const Eigen::Vector3f> samples,
                                             const SE3& T_world_camera) const {
  const auto some = thinned(samples, kAgreementSamples);
  std::vector<size_t> agreeing;
  for (size_t i = 0; i < parts_.size(); ++i) {
    const SE3 T_part_camera = pose(parts_[i]).inverse() * T_world_camera;
    const Submap& submap = parts_[i].submap;
    if (!submap.is_near(T_part_camera.translation.cast<float>(), options_.limits.max_depth_m)) continue;
    const auto [known, agreed] =
        submap.agreement(moved(some, T_part_camera), T_part_camera.translation.cast<float>());
    if (known >= kMinKnown && static_cast<double>(agreed) >= kMinAgreeing * static_cast<double>(known))
      agreeing.push_back(i);
  }
  return agreeing;
}

/// Returns the blocks that the surface in view lacks: in the oldest of `parts` that owns a sample of it, else
/// in one of them or a new one, which is then added to `parts`.
std::vector<LiveMesh::WantedBlock> LiveMesh::wanted_blocks(std::span<const Eigen::Vector3f> samples,
                                                           const SE3& T_world_camera, KeyframeId keyframe,
                                                           std::vector<size_t>& parts) {
  constexpr size_t kNobody = ~size_t{0};
  std::vector<size_t> owner(samples.size(), kNobody);
  for (const size_t i : parts) {
    const SE3 T_part_camera = pose(parts_[i]).inverse() * T_world_camera;
    const auto points = moved(samples, T_part_camera);
    const Eigen::Vector3f eye = T_part_camera.translation.cast<float>();
    for (size_t k = 0; k < points.size(); ++k) {
      if (owner[k] == kNobody && parts_[i].submap.owns(points[k], eye)) owner[k] = i;
    }
  }
  const auto without_owner = std::ranges::count(owner, kNobody);
  if (without_owner > 0) {
    const double share = static_cast<double>(without_owner) / static_cast<double>(samples.size());
    std::ranges::replace(owner, kNobody, part_for_new_surface(keyframe, share, parts));
  }
  const auto reach = static_cast<float>(scale_.truncation_m);
  std::vector<WantedBlock> wanted;
  for (const size_t i : parts) {
    const Submap& submap = parts_[i].submap;
    if (submap.is_released()) continue;
    const SE3 T_part_camera = pose(parts_[i]).inverse() * T_world_camera;
    const auto points = moved(samples, T_part_camera);
    const Eigen::Vector3f eye = T_part_camera.translation.cast<float>();
    for (size_t k = 0; k < points.size(); ++k) {
      if (owner[k] != i) continue;
      const Eigen::Vector3f along = reach * (points[k] - eye).normalized();
      for (const float step : {-1.0F, 0.0F, 1.0F}) {
        const VoxelKey block = submap.block_at(points[k] + step * along);
        if (!submap.has_block(block)) wanted.emplace_back(i, block);
      }
    }
  }
  return wanted;
}

/// Adds blocks, and releases submaps for them. Those that would not fit are left out.
void LiveMesh::allocate(std::vector<WantedBlock> blocks) {
  std::ranges::sort(blocks);
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  blocks.resize(std::min(blocks.size(), options_.max_blocks));
  while (blocks_in_memory() + blocks.size() > options_.max_blocks) {
    const auto oldest = least_recently_seen();
    if (!oldest) break;
    take_stale(*oldest, std::numeric_limits<size_t>::max(), released_);
    parts_[*oldest].submap.release();
  }
  for (const auto& [part, block] : blocks) {
    if (!parts_[part].submap.is_released()) parts_[part].submap.touch(block);
  }
}

/// Returns the newest of `parts` if it may grow, else a new part. `new_share`: of the view.
size_t LiveMesh::part_for_new_surface(KeyframeId keyframe, double new_share, std::vector<size_t>& parts) {
  if (!parts.empty() && !parts_[parts.back()].submap.is_released()) {
    Part& newest = parts_[parts.back()];
    if (new_share < kMinNew || keyframe <= newest.newest) return parts.back();
    if (newest.keyframes < kKeyframesPerSubmap) {
      newest.newest = keyframe;
      ++newest.keyframes;
      return parts.back();
    }
  }
  parts_.push_back({.submap = Submap(keyframe, scale_), .newest = keyframe});
  parts.push_back(parts_.size() - 1);
  return parts.back();
}

/// Notes that the parts overlap. What a newer one shows of the older ones is extracted again, without that.
void LiveMesh::link(std::span<const size_t> parts) {
  for (size_t n = 1; n < parts.size(); ++n) {
    Part& newer = parts_[parts[n]];
    const size_t before = newer.older.size();
    for (const size_t older : parts.first(n)) {
      if (std::ranges::find(newer.older, older) == newer.older.end()) newer.older.push_back(older);
    }
    if (newer.older.size() > before) newer.submap.mark_all();
  }
}

/// Of the parts that have voxels.
std::optional<size_t> LiveMesh::least_recently_seen() const {
  std::optional<size_t> oldest;
  for (size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].submap.is_released()) continue;
    if (!oldest || parts_[i].last_view < parts_[*oldest].last_view) oldest = i;
  }
  return oldest;
}

/// Appends the pieces of a part that do not show all of it, until there are `most`.
void LiveMesh::take_stale(size_t part, size_t most, std::vector<MeshPiece>& pieces) {
  const auto& chunks = parts_[part].submap.chunks();
  for (size_t chunk = 0; chunk < chunks.size() && pieces.size() < most; ++chunk) {
    if (!chunks[chunk].is_stale()) continue;
    if (auto piece = take(part, chunk)) pieces.push_back(*std::move(piece));
  }
}

/// While there is still some memory, releases the part that was not seen for longest, unless it is in view,
/// with its last pieces first: a few at a time, since all of them may take long.
void LiveMesh::retire(size_t most, std::vector<MeshPiece>& pieces) {
  constexpr double kFrom = 0.875;  // of the memory
  if (static_cast<double>(blocks_in_memory()) < kFrom * static_cast<double>(options_.max_blocks)) return;
  const auto oldest = least_recently_seen();
  if (!oldest || parts_[*oldest].last_view == views_) return;
  take_stale(*oldest, most, pieces);
  if (pieces.size() < most) parts_[*oldest].submap.release();
}

std::vector<MeshPiece> LiveMesh::take_changed(size_t most, bool all) {
  std::vector<MeshPiece> pieces;
  const auto sent = released_.begin() + static_cast<long>(std::min(most, released_.size()));
  pieces.assign(std::make_move_iterator(released_.begin()), std::make_move_iterator(sent));
  released_.erase(released_.begin(), sent);
  retire(most, pieces);
  for (size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].submap.is_released()) continue;
    const auto& chunks = parts_[i].submap.chunks();
    for (size_t chunk = 0; chunk < chunks.size() && pieces.size() < most; ++chunk) {
      if (!(all ? chunks[chunk].is_stale() : chunks[chunk].is_due())) continue;
      if (auto piece = take(i, chunk)) pieces.push_back(*std::move(piece));
    }
  }
  return pieces;
}

/// Extracts a piece without what older parts show. nullopt if it is empty, as it was before.
std::optional<MeshPiece> LiveMesh::take(size_t part, size_t chunk) {
  Part& owner = parts_[part];
  SurfacePiece surface = owner.submap.extract(chunk);
  for (const size_t i : owner.older) {
    const SE3 T_older_owner = pose(parts_[i]).inverse() * pose(owner);
    const auto points = moved(surface.mesh.points, T_older_owner),
               normals = moved(surface.normals, {T_older_owner.rotation, Eigen::Vector3d::Zero()});
    surface =
        without_triangles(surface, [&](size_t k) { return parts_[i].submap.shows(points[k], normals[k]); });
  }
  owner.submap.note_shown(chunk, surface);
  owner.piece_of.resize(owner.submap.chunks().size(), kNoPiece);
  uint32_t& index = owner.piece_of[chunk];
  if (index == kNoPiece && surface.mesh.triangles.empty()) return std::nullopt;
  if (index == kNoPiece) index = pieces_++;
  return MeshPiece{index, owner.submap.anchor(), std::move(surface)};
}

size_t LiveMesh::blocks_in_memory() const {
  size_t count = 0;
  for (const Part& part : parts_) count += part.submap.blocks_in_memory();
  return count;
}

}  // namespace kinloop
