#include "kinloop/dense/voxel_grid.hpp"

#include <limits>

namespace kinloop {
namespace {

constexpr size_t kFirstTable = 1024;

/// Sums of bytes over more pixels than this might not fit 32 bits.
constexpr uint32_t kMostPixels = 1U << 23;

/// The middle bits: the lowest are scattered least, the highest chose the grid.
size_t first_slot(VoxelKey key) {
  constexpr int kLowBits = 28;
  return scatter(key) >> kLowBits;
}

/// Forgets half the weight of what was seen so far, which keeps the means.
void halve(Voxel& voxel) {
  voxel.pixels /= 2;
  for (auto& sum : voxel.steps) sum /= 2;
  for (auto& sum : voxel.colors) sum /= 2;
}

/// Makes room for one more; a quarter more at a time, since memory counts for more here than copying.
void reserve_one(std::vector<Voxel>& voxels) {
  if (voxels.size() == voxels.capacity()) voxels.reserve(kFirstTable + voxels.size() + voxels.size() / 4);
}

}  // namespace

void VoxelGrid::add(const VoxelSample& sample, uint32_t view) {
  Voxel& voxel = find_or_insert(sample.key);
  const auto view_bits = static_cast<uint16_t>(view);
  if (voxel.views == 0 || voxel.last_view != view_bits) {
    if (voxel.views < std::numeric_limits<uint16_t>::max()) ++voxel.views;
    voxel.last_view = view_bits;
  }
  voxel.pixels += sample.pixels;
  for (size_t i = 0; i < 3; ++i) {
    voxel.steps[i] += sample.steps[i];
    voxel.colors[i] += sample.colors[i];
  }
  if (voxel.pixels >= kMostPixels) halve(voxel);
}

Voxel& VoxelGrid::find_or_insert(VoxelKey key) {
  // At most two thirds full, so that probing stays short.
  if (3 * (voxels_.size() + 1) > 2 * table_.size()) grow_table();
  const size_t mask = table_.size() - 1;
  size_t slot = first_slot(key) & mask;
  while (table_[slot] != 0) {
    Voxel& voxel = voxels_[table_[slot] - 1];
    if (voxel.key == key) return voxel;
    slot = (slot + 1) & mask;
  }
  reserve_one(voxels_);
  voxels_.push_back({.key = key});
  table_[slot] = static_cast<uint32_t>(voxels_.size());
  return voxels_.back();
}

void VoxelGrid::grow_table() {
  table_.assign(std::max(kFirstTable, 2 * table_.size()), 0);
  const size_t mask = table_.size() - 1;
  for (size_t i = 0; i < voxels_.size(); ++i) {
    size_t slot = first_slot(voxels_[i].key) & mask;
    while (table_[slot] != 0) slot = (slot + 1) & mask;
    table_[slot] = static_cast<uint32_t>(i + 1);
  }
}

Eigen::Vector3f mean_point(const Voxel& voxel, double voxel_m) {
  constexpr VoxelKey kAxisMask = (VoxelKey{1} << kVoxelAxisBits) - 1;
  Eigen::Vector3f point;
  for (int axis = 0; axis < 3; ++axis) {
    const auto corner = static_cast<int64_t>(voxel.key >> (axis * kVoxelAxisBits) & kAxisMask) - kVoxelOrigin;
    // Positions were cut off to whole steps: half a step is what they lost on average.
    const double steps = static_cast<double>(voxel.steps[static_cast<size_t>(axis)]) / voxel.pixels + 0.5;
    point[axis] = static_cast<float>((static_cast<double>(corner) + steps / kVoxelSteps) * voxel_m);
  }
  return point;
}

Rgb mean_color(const Voxel& voxel) {
  Rgb color{};
  for (size_t i = 0; i < 3; ++i) {
    color[i] = static_cast<uint8_t>((voxel.colors[i] + voxel.pixels / 2) / voxel.pixels);
  }
  return color;
}

}  // namespace kinloop
