#include <algorithm>

#include "dense/live_mesh/tsdf_blocks.hpp"
#include "dense/mesh/surface_nets.hpp"

namespace kinloop {
namespace {

constexpr int kChunkEdge = 1 << kChunkBits;
constexpr int kMargin = 1;  // voxels around the chunk on either side: its quads have corners in them
constexpr int kBrickEdge = kChunkEdge + 2 * kMargin;
constexpr uint32_t kNone = ~uint32_t{0};

/// The voxels of a chunk and its margin in one array.
class Brick {
 public:
  /// Distances in the array between neighbours along each axis.
  static constexpr std::array<size_t, 3> kStep = {1, kBrickEdge, size_t{kBrickEdge} * kBrickEdge};
  static constexpr size_t kSize = kBrickEdge * kStep[2];

  Brick(const TsdfBlocks& blocks, VoxelKey chunk) : voxels_(kSize), first_(voxel_of(chunk)) {
    for (int z = -kMargin; z < kChunkEdge + kMargin; z = next_block(z)) {
      for (int y = -kMargin; y < kChunkEdge + kMargin; y = next_block(y)) {
        for (int x = -kMargin; x < kChunkEdge + kMargin; x = next_block(x)) {
          const TsdfBlock* block = blocks.find(voxel_key(Eigen::Vector3i(first_ + Eigen::Vector3i(x, y, z))));
          if (block != nullptr && block->voxels) copy(*block, {x, y, z});
        }
      }
    }
  }

  /// Index of a voxel, relative to the chunk's first one.
  static size_t index(const Eigen::Vector3i& voxel) {
    const auto part = [&](int axis) {
      return static_cast<size_t>(voxel(axis) + kMargin) * kStep[static_cast<size_t>(axis)];
    };
    return part(0) + part(1) + part(2);
  }

  /// Inverse of `index`, in the coordinates of the blocks.
  [[nodiscard]] Eigen::Vector3i voxel(size_t index) const {
    const Eigen::Vector3i in_brick(static_cast<int>(index % kBrickEdge),
                                   static_cast<int>(index / kStep[1] % kBrickEdge),
                                   static_cast<int>(index / kStep[2]));
    return first_ + in_brick - Eigen::Vector3i::Constant(kMargin);
  }

  [[nodiscard]] const TsdfVoxel& operator[](size_t index) const { return voxels_[index]; }

 private:
  static int next_block(int x) { return (x & ~(kTsdfBlockEdge - 1)) + kTsdfBlockEdge; }

  /// Copies the voxels of a block from `from` on, as far as they are in the brick.
  void copy(const TsdfBlock& block, const Eigen::Vector3i& from) {
    const Eigen::Vector3i end =
        from.unaryExpr([](int x) { return std::min(next_block(x), kChunkEdge + kMargin); });
    for (int z = from.z(); z < end.z(); ++z) {
      for (int y = from.y(); y < end.y(); ++y) {
        const auto* row = &(*block.voxels)[index_in_tsdf_block(first_ + Eigen::Vector3i(from.x(), y, z))];
        std::copy_n(row, end.x() - from.x(), &voxels_[index({from.x(), y, z})]);
      }
    }
  }

  std::vector<TsdfVoxel> voxels_;
  Eigen::Vector3i first_;
};

/// Distance in the brick from the first corner of a cell to corner k.
constexpr std::array<size_t, 8> kCorner = [] {
  std::array<size_t, 8> offsets{};
  for (size_t k = 0; k < 8; ++k)
    offsets[k] = (k & 1) * Brick::kStep[0] + (k >> 1 & 1) * Brick::kStep[1] + (k >> 2) * Brick::kStep[2];
  return offsets;
}();

/// Surface nets in a brick.
class SurfaceExtraction {
 public:
  SurfaceExtraction(const Brick& brick, const TsdfScale& scale, double min_weight)
      : brick_(brick),
        scale_(scale),
        min_weight_(static_cast<int>(std::max(1.0, min_weight * TsdfVoxel::kWeightUnits))),
        vertex_of_(Brick::kSize, kNone) {}

  /// Adds the quads across the edges from the voxels of a block, given its first one in the brick.
  void add_block(size_t first) {
    for (size_t z = 0; z < kTsdfBlockEdge; ++z) {
      for (size_t y = 0; y < kTsdfBlockEdge; ++y) {
        for (size_t x = 0; x < kTsdfBlockEdge; ++x)
          add_quads(first + x + y * Brick::kStep[1] + z * Brick::kStep[2]);
      }
    }
  }

  SurfacePiece take() { return std::move(piece_); }

 private:
  [[nodiscard]] bool known(const TsdfVoxel& voxel) const { return voxel.weight >= min_weight_; }

  void add_quads(size_t voxel) {
    const TsdfVoxel& here = brick_[voxel];
    if (!known(here)) return;
    for (size_t axis = 0; axis < 3; ++axis) {
      const TsdfVoxel& next = brick_[voxel + Brick::kStep[axis]];
      if ((here.distance < 0) != (next.distance < 0) && known(next)) add_quad(voxel, axis, here.distance < 0);
    }
  }

  /// Adds the quad of the four cells around the edge from `voxel` along `axis`.
  void add_quad(size_t voxel, size_t axis, bool solid_first) {
    const size_t u = Brick::kStep[(axis + 1) % 3], v = Brick::kStep[(axis + 2) % 3];
    std::array<uint32_t, 4> corners{};
    const std::array<size_t, 4> cells = {voxel - u - v, voxel - v, voxel, voxel - u};
    for (size_t k = 0; k < 4; ++k) {
      corners[k] = vertex(cells[k]);
      if (corners[k] == kNone) return;
    }
    if (!solid_first) std::swap(corners[1], corners[3]);
    piece_.mesh.triangles.push_back({corners[0], corners[1], corners[2]});
    piece_.mesh.triangles.push_back({corners[0], corners[2], corners[3]});
  }

  /// Returns the vertex of a cell, which is made when it is first needed; kNone if a corner is unknown.
  uint32_t vertex(size_t cell) {
    uint32_t& index = vertex_of_[cell];
    if (index != kNone) return index;
    CellCorners distances{};
    for (size_t k = 0; k < 8; ++k) {
      const TsdfVoxel& voxel = brick_[cell + kCorner[k]];
      if (!known(voxel)) return kNone;
      distances[k] = voxel.distance;
    }
    const auto in_cell = surface_vertex(distances);
    if (!in_cell) return kNone;
    index = static_cast<uint32_t>(piece_.mesh.points.size());
    const Eigen::Vector3d p_voxels = brick_.voxel(cell).cast<double>() + *in_cell;
    piece_.mesh.points.push_back((p_voxels * scale_.voxel_m).cast<float>());
    piece_.mesh.colors.push_back(color(cell, in_cell->cast<float>()));
    piece_.normals.push_back(gradient(distances).normalized());
    return index;
  }

  /// Points from the solid to the free side.
  static Eigen::Vector3f gradient(const CellCorners& distances) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (size_t k = 0; k < 8; ++k) {
      for (int axis = 0; axis < 3; ++axis) sum(axis) += (k >> axis & 1) != 0 ? distances[k] : -distances[k];
    }
    return sum;
  }

  /// Interpolates between the corners of a cell that have a colour.
  [[nodiscard]] Rgb color(size_t cell, const Eigen::Vector3f& in_cell) const {
    Eigen::Array3f sum = Eigen::Array3f::Zero();
    float total = 0;
    for (size_t k = 0; k < 8; ++k) {
      const TsdfVoxel& voxel = brick_[cell + kCorner[k]];
      float weight = voxel.color_weight > 0 ? 1 : 0;
      for (int axis = 0; axis < 3; ++axis) weight *= (k >> axis & 1) != 0 ? in_cell(axis) : 1 - in_cell(axis);
      sum += weight * Eigen::Array3f(voxel.color[0], voxel.color[1], voxel.color[2]);
      total += weight;
    }
    if (total <= 0) return {};
    const Eigen::Array<uint8_t, 3, 1> mean = (sum / total).round().cast<uint8_t>();
    return {mean(0), mean(1), mean(2)};
  }

  const Brick& brick_;
  TsdfScale scale_;
  int min_weight_;
  std::vector<uint32_t> vertex_of_;  // by cell, as voxels of the brick
  SurfacePiece piece_;
};

}  // namespace

SurfacePiece extract_piece(const TsdfBlocks& blocks, VoxelKey chunk, std::span<const uint32_t> present,
                           const TsdfScale& scale, double min_weight) {
  const Brick brick(blocks, chunk);
  SurfaceExtraction extraction(brick, scale, min_weight);
  for (const uint32_t i : present) {
    extraction.add_block(Brick::index(voxel_of(blocks.all()[i].first) - voxel_of(chunk)));
  }
  return extraction.take();
}

SurfacePiece without_triangles(const SurfacePiece& piece,
                               const std::function<bool(size_t vertex)>& is_left_out) {
  std::vector<bool> left_out(piece.mesh.points.size());
  for (size_t i = 0; i < left_out.size(); ++i) left_out[i] = is_left_out(i);
  SurfacePiece kept;
  std::vector<uint32_t> new_index(left_out.size(), kNone);
  const auto kept_vertex = [&](uint32_t i) {
    if (new_index[i] == kNone) {
      new_index[i] = static_cast<uint32_t>(kept.mesh.points.size());
      kept.mesh.points.push_back(piece.mesh.points[i]);
      kept.mesh.colors.push_back(piece.mesh.colors[i]);
      kept.normals.push_back(piece.normals[i]);
    }
    return new_index[i];
  };
  for (const auto& [a, b, c] : piece.mesh.triangles) {
    if (left_out[a] && left_out[b] && left_out[c]) continue;
    const Triangle triangle = {kept_vertex(a), kept_vertex(b), kept_vertex(c)};
    kept.mesh.triangles.push_back(triangle);
  }
  return kept;
}

}  // namespace kinloop
