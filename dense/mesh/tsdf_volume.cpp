// The only file that includes OpenVDB, which is slow to compile. It uses the nodes of OpenVDB's trees, which
// are templates, and not its Tree, which has virtual functions that read and write files: these alone would
// need the library, which loads a log library that starts threads before main().

#include "dense/mesh/tsdf_volume.hpp"

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_OPENVDB

#include <algorithm>
#include <array>
#include <cmath>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <openvdb/version.h>
#undef OPENVDB_USE_DELAYED_LOADING  // of voxels, from files
#include <openvdb/tree/InternalNode.h>
#include <openvdb/tree/LeafNode.h>
#include <openvdb/tree/RootNode.h>
#pragma GCC diagnostic pop

#include "dense/mesh/surface_nets.hpp"
#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

using openvdb::Coord;

/// The nodes of openvdb::FloatTree and of openvdb::Int32Tree.
template <class Value>
using Grid = openvdb::tree::RootNode<
    openvdb::tree::InternalNode<openvdb::tree::InternalNode<openvdb::tree::LeafNode<Value, 3>, 4>, 5>>;
using FloatGrid = Grid<float>;
using Leaf = FloatGrid::LeafNodeType;

constexpr int kLeafVoxels = Leaf::DIM;  // along an edge of a leaf

Coord along(int axis, int steps = 1) {
  Coord c(0, 0, 0);
  c[static_cast<size_t>(axis)] = steps;
  return c;
}

/// Reads the voxels of a grid. A voxel is mostly in the leaf of the one before.
template <class Value>
class VoxelReader {
 public:
  using GridLeaf = typename Grid<Value>::LeafNodeType;

  explicit VoxelReader(const Grid<Value>& grid) : grid_(&grid) {}

  Value operator()(const Coord& voxel) {
    const Coord origin = voxel & ~(kLeafVoxels - 1);
    if (leaf_ == nullptr || leaf_->origin() != origin) leaf_ = grid_->probeConstLeaf(voxel);
    return leaf_ == nullptr ? grid_->background() : leaf_->getValue(voxel);
  }

 private:
  const Grid<Value>* grid_;
  const GridLeaf* leaf_ = nullptr;
};

}  // namespace

/// Distances and their weights, as two grids with identical leaves.
struct TsdfVolume::Volume {
  struct Block {
    Leaf* distance;
    Leaf* weight;
  };

  explicit Volume(float truncation_m) : distance(truncation_m), weight(0) {}

  void touch(const Coord& voxel) {
    Leaf* existing = distance.probeLeaf(voxel);
    if (existing != nullptr) return;
    blocks.push_back({distance.touchLeaf(voxel), weight.touchLeaf(voxel)});
  }

  FloatGrid distance;
  FloatGrid weight;
  std::vector<Block> blocks;  // in order of first allocation
};

namespace {

/// Updates the voxels of one block by projecting them into a view.
class BlockUpdate {
 public:
  BlockUpdate(const UndistortedDepth& view, const DenseCamera& camera, const MeshOptions& options)
      : view_(view), camera_(camera), options_(options), T_camera_world_(view.T_world_camera.inverse()) {
    const Eigen::Matrix3d R = T_camera_world_.R() * options.voxel_m;
    for (int axis = 0; axis < 3; ++axis) step_[static_cast<size_t>(axis)] = R.col(axis);
  }

  void operator()(Leaf& distance, Leaf& weight) const {
    if (!in_view(distance.origin())) return;
    const Eigen::Vector3d p_corner = in_camera(distance.origin());
    for (unsigned i = 0; i < Leaf::SIZE; ++i) {
      const Coord c = Leaf::offsetToLocalCoord(i);
      update(distance, weight, i, p_corner + c.x() * step_[0] + c.y() * step_[1] + c.z() * step_[2]);
    }
  }

 private:
  [[nodiscard]] Eigen::Vector3d in_camera(const Coord& voxel) const {
    return T_camera_world_ * (Eigen::Vector3d(voxel.x(), voxel.y(), voxel.z()) * options_.voxel_m);
  }

  /// Returns whether the block may be visible, within the depth limit.
  [[nodiscard]] bool in_view(const Coord& origin) const {
    const double radius_m = std::sqrt(3.0) / 2 * kLeafVoxels * options_.voxel_m;
    const Eigen::Vector3d center = in_camera(origin) + kLeafVoxels / 2.0 * (step_[0] + step_[1] + step_[2]);
    if (center.z() < options_.limits.min_depth_m || center.z() > options_.limits.max_depth_m + radius_m)
      return false;
    const double margin_px = radius_m * camera_.color.fx / center.z();
    return camera_.color.contains(camera_.color.project(center), -margin_px);
  }

  void update(Leaf& distance, Leaf& weight, unsigned i, const Eigen::Vector3d& p_stamp) const {
    const double nearest_m = options_.limits.min_depth_m / 2;
    if (p_stamp.z() < nearest_m) return;
    const Eigen::Vector3d p_camera =
        camera_.undo_deskew(p_stamp, view_.velocity, view_.depth_stamp_difference_s);
    if (p_camera.z() < nearest_m) return;
    const Eigen::Vector2d pixel = camera_.color.project(p_camera);
    const int col = static_cast<int>(std::lround(pixel.x())), row = static_cast<int>(std::lround(pixel.y()));
    if (col < 0 || row < 0 || col >= camera_.color.width || row >= camera_.color.height) return;
    const double depth_m = view_.depth_m.at<float>(row, col);
    if (!(depth_m > 0)) return;
    const double truncation_m = options_.truncation_voxels * options_.voxel_m;
    const double ahead_m = depth_m - p_camera.z();
    if (ahead_m < -truncation_m) return;  // unknown behind the surface
    // A pixel at a depth edge may be a flying pixel: use it for free space only, not for a surface.
    if (ahead_m < truncation_m && view_.usable.at<uint8_t>(row, col) == 0) return;
    // Weight by the noise of depth here: free space far in front of a wall is as uncertain as the wall's
    // distance.
    const double sigma_ratio = camera_.noise.sigma_m(1.0) / camera_.noise.sigma_m(p_camera.z());
    const auto w = static_cast<float>(sigma_ratio * sigma_ratio);
    float* values = distance.buffer().data();
    float* weights = weight.buffer().data();
    const auto measured = static_cast<float>(std::min(ahead_m, truncation_m));
    values[i] = (values[i] * weights[i] + measured * w) / (weights[i] + w);
    weights[i] += w;
  }

  const UndistortedDepth& view_;
  const DenseCamera& camera_;
  const MeshOptions& options_;
  SE3 T_camera_world_;
  std::array<Eigen::Vector3d, 3> step_;  // one voxel along each axis, in the camera frame
};

/// The surface in all voxels.
class SurfaceNets {
 public:
  SurfaceNets(const FloatGrid& distance, const FloatGrid& weight, const MeshOptions& options)
      : distance_(distance), weight_(weight), options_(options), vertex_of_(-1), vertex_(vertex_of_) {
    distance.getNodes(leaves_);
  }

  ColoredMesh run() {
    for (const Leaf* leaf : leaves_) {
      for (unsigned i = 0; i < Leaf::SIZE; ++i) add_vertex(leaf->offsetToGlobalCoord(i));
    }
    for (const Leaf* leaf : leaves_) {
      for (unsigned i = 0; i < Leaf::SIZE; ++i) add_faces(leaf->offsetToGlobalCoord(i));
    }
    mesh_.colors.resize(mesh_.points.size());
    return std::move(mesh_);
  }

 private:
  bool known(const Coord& voxel) { return weight_(voxel) >= static_cast<float>(options_.min_weight); }

  void add_vertex(const Coord& cell) {
    CellCorners corners{};
    for (int k = 0; k < 8; ++k) {
      const Coord voxel = cell.offsetBy(k & 1, k >> 1 & 1, k >> 2);
      if (!known(voxel)) return;
      corners[static_cast<size_t>(k)] = distance_(voxel);
    }
    const auto in_cell = surface_vertex(corners);
    if (!in_cell) return;
    vertex_of_.setValueOn(cell, static_cast<int>(mesh_.points.size()));
    const Eigen::Vector3d p = (Eigen::Vector3d(cell.x(), cell.y(), cell.z()) + *in_cell) * options_.voxel_m;
    mesh_.points.push_back(p.cast<float>());
  }

  void add_faces(const Coord& voxel) {
    if (!known(voxel)) return;
    const float here = distance_(voxel);
    for (int axis = 0; axis < 3; ++axis) {
      const Coord next = voxel + along(axis);
      if (!known(next)) continue;
      const float there = distance_(next);
      if ((here < 0) != (there < 0)) add_quad(voxel, axis, here < 0);
    }
  }

  /// Adds the quad of the four cells around the edge from `voxel` along `axis`.
  void add_quad(const Coord& voxel, int axis, bool solid_first) {
    const Coord u = along((axis + 1) % 3, -1), v = along((axis + 2) % 3, -1);
    std::array<uint32_t, 4> corners{};
    const std::array<Coord, 4> cells = {voxel + u + v, voxel + v, voxel, voxel + u};
    for (size_t k = 0; k < 4; ++k) {
      const int vertex = vertex_(cells[k]);
      if (vertex < 0) return;
      corners[k] = static_cast<uint32_t>(vertex);
    }
    if (!solid_first) std::swap(corners[1], corners[3]);
    mesh_.triangles.push_back({corners[0], corners[1], corners[2]});
    mesh_.triangles.push_back({corners[0], corners[2], corners[3]});
  }

  VoxelReader<float> distance_;
  VoxelReader<float> weight_;
  const MeshOptions& options_;
  Grid<int32_t> vertex_of_;
  VoxelReader<int32_t> vertex_;
  std::vector<const Leaf*> leaves_;
  ColoredMesh mesh_;
};

}  // namespace

bool tsdf_available() {
  return true;
}

TsdfVolume::TsdfVolume(const DenseCamera& camera, const MeshOptions& options)
    : camera_(camera),
      options_(options),
      volume_(std::make_unique<Volume>(static_cast<float>(options.truncation_voxels * options.voxel_m))) {}

TsdfVolume::~TsdfVolume() = default;

void TsdfVolume::allocate_blocks(const UndistortedDepth& view) {
  // Allocates blocks along the rays of every few pixels, which at the maximum depth are closer than a block's
  // edge.
  constexpr int kStridePx = 4;
  const double reach_m = options_.truncation_voxels * options_.voxel_m;
  const double step_m = kLeafVoxels * options_.voxel_m / 2;
  std::vector<Coord> touched;
  for (int row = 0; row < camera_.color.height; row += kStridePx) {
    for (int col = 0; col < camera_.color.width; col += kStridePx) {
      if (view.usable.at<uint8_t>(row, col) == 0) continue;
      const double depth_m = view.depth_m.at<float>(row, col);
      for (double z = depth_m - reach_m; z <= depth_m + reach_m; z += step_m) {
        const Eigen::Vector3d p_camera = camera_.deskew(camera_.color.unproject(Eigen::Vector2d(col, row), z),
                                                        row, view.velocity, view.depth_stamp_difference_s);
        const Eigen::Vector3d p = view.T_world_camera * p_camera / options_.voxel_m;
        const auto origin = [](double x) { return static_cast<int>(std::floor(x)) & ~(kLeafVoxels - 1); };
        touched.emplace_back(origin(p.x()), origin(p.y()), origin(p.z()));
      }
    }
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  for (const Coord& origin : touched) volume_->touch(origin);
}

void TsdfVolume::integrate(const UndistortedDepth& view, int threads) {
  const BlockUpdate update(view, camera_, options_);
  parallel_for(volume_->blocks.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) update(*volume_->blocks[i].distance, *volume_->blocks[i].weight);
  });
}

ColoredMesh TsdfVolume::surface() const {
  return SurfaceNets(volume_->distance, volume_->weight, options_).run();
}

size_t TsdfVolume::bytes() const {
  return volume_->distance.memUsage() + volume_->weight.memUsage();
}

}  // namespace kinloop

#else

namespace kinloop {

struct TsdfVolume::Volume {};

bool tsdf_available() {
  return false;
}

TsdfVolume::TsdfVolume(const DenseCamera& camera, const MeshOptions& options)
    : camera_(camera), options_(options) {
  throw UsageError("meshes: this build has no OpenVDB; install libopenvdb-dev and rebuild kinloop");
}

TsdfVolume::~TsdfVolume() = default;
void TsdfVolume::allocate_blocks(const UndistortedDepth&) {}
void TsdfVolume::integrate(const UndistortedDepth&, int) {}
ColoredMesh TsdfVolume::surface() const {
  return {};
}
size_t TsdfVolume::bytes() const {
  return 0;
}

}  // namespace kinloop

#endif
