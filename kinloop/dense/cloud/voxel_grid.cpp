#include "kinloop/dense/cloud/voxel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kinloop {
namespace {

constexpr size_t kFirstTable = 1024;
constexpr float kColorSteps = 256;

/// Reserves one more element, growing by a quarter: memory matters more here than copying.
void reserve_one(std::vector<Voxel>& voxels) {
  if (voxels.size() == voxels.capacity()) voxels.reserve(kFirstTable + voxels.size() + voxels.size() / 4);
}

void mix_color(Voxel& voxel, const VoxelSample& sample) {
  // A colour with zero weight is better than none.
  const float weight = std::max(sample.color_weight * sample.pixels, std::numeric_limits<float>::min());
  voxel.color_weight += weight;
  const float share = weight / voxel.color_weight;
  for (size_t i = 0; i < 3; ++i) {
    const auto before = static_cast<float>(voxel.color[i]);
    const float after = before + share * (kColorSteps * static_cast<float>(sample.color[i]) - before);
    voxel.color[i] = static_cast<uint16_t>(std::lround(after));
  }
}

}  // namespace

void VoxelGrid::add(const VoxelSample& sample, uint32_t view) {
  Voxel& voxel = find_or_insert(sample.key);
  const auto view_bits = static_cast<uint16_t>(view);
  if (voxel.views == 0 || voxel.last_view != view_bits) {
    if (voxel.views < std::numeric_limits<uint16_t>::max()) ++voxel.views;
    voxel.last_view = view_bits;
  }
  const float weight = sample.pixels / sample.variance_m2;
  voxel.weight += weight;
  voxel.pixels += sample.pixels;
  voxel.offset_sum += weight * sample.offset;
  voxel.normal_sum += weight * sample.normal;
  mix_color(voxel, sample);
}

const Voxel* VoxelGrid::find(VoxelKey key) const {
  if (table_.empty()) return nullptr;
  const uint32_t entry = table_[slot_of(key)];
  return entry == 0 ? nullptr : &voxels_[entry - 1];
}

void VoxelGrid::erase_from(VoxelKey key) {
  std::erase_if(voxels_, [=](const Voxel& voxel) { return voxel.key >= key; });
  rebuild_table(table_.size());
}

Voxel& VoxelGrid::find_or_insert(VoxelKey key) {
  // At most two thirds full, to keep probing short.
  if (3 * (voxels_.size() + 1) > 2 * table_.size()) rebuild_table(std::max(kFirstTable, 2 * table_.size()));
  const size_t slot = slot_of(key);
  if (table_[slot] != 0) return voxels_[table_[slot] - 1];
  reserve_one(voxels_);
  voxels_.emplace_back().key = key;
  table_[slot] = static_cast<uint32_t>(voxels_.size());
  return voxels_.back();
}

/// Slot of the voxel, or the free slot where it would be inserted.
size_t VoxelGrid::slot_of(VoxelKey key) const {
  constexpr int kLowBits = 28;  // the lowest bits are hashed least, the highest select the grid
  const size_t mask = table_.size() - 1;
  size_t slot = (hash_key(key) >> kLowBits) & mask;
  while (table_[slot] != 0 && voxels_[table_[slot] - 1].key != key) slot = (slot + 1) & mask;
  return slot;
}

void VoxelGrid::rebuild_table(size_t size) {
  table_.assign(size, 0);
  for (size_t i = 0; i < voxels_.size(); ++i) table_[slot_of(voxels_[i].key)] = static_cast<uint32_t>(i + 1);
}

Eigen::Vector3f mean_point(const Voxel& voxel, double voxel_m) {
  const Eigen::Vector3d offset = (voxel.offset_sum / voxel.weight).cast<double>();
  return ((voxel_of(voxel.key).cast<double>() + offset) * voxel_m).cast<float>();
}

Rgb mean_color(const Voxel& voxel) {
  Rgb color{};
  for (size_t i = 0; i < 3; ++i) {
    color[i] = static_cast<uint8_t>(std::min((voxel.color[i] + 128U) / 256U, 255U));
  }
  return color;
}

}  // namespace kinloop
