#include "dense/surfels/voxel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dense/rounded.hpp"

namespace kinloop {
namespace {

constexpr size_t kFirstTable = 1024;
constexpr float kColorSteps = 256;

/// Reserves one more element, growing by a quarter: memory matters more here than copying.
template <class T>
void reserve_one(std::vector<T>& elements) {
  if (elements.size() == elements.capacity()) {
    elements.reserve(kFirstTable / 4 + elements.size() + elements.size() / 4);
  }
}

/// Position of a voxel in its cell.
size_t place_in_cell(VoxelKey key) {
  constexpr VoxelKey kAxis = (VoxelKey{1} << kCellBits) - 1;
  size_t place = 0;
  for (int axis = 0; axis < 3; ++axis) {
    place |= (key >> (axis * kVoxelAxisBits) & kAxis) << (axis * kCellBits);
  }
  return place;
}

void mix_color(Voxel& voxel, const VoxelSample& sample) {
  // A colour with zero weight is better than none.
  const float weight = std::max(sample.color_weight * sample.pixels, std::numeric_limits<float>::min());
  voxel.color_weight += weight;
  const float share = weight / voxel.color_weight;
  for (size_t i = 0; i < 3; ++i) {
    const auto before = static_cast<float>(voxel.color[i]);
    const float after = before + share * (kColorSteps * static_cast<float>(sample.color[i]) - before);
    voxel.color[i] = static_cast<uint16_t>(rounded(after));
  }
}

void mix(Voxel& voxel, const VoxelSample& sample, uint32_t view) {
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

}  // namespace

void VoxelGrid::add(std::span<const VoxelSample> samples, std::span<const uint32_t> which, uint32_t view) {
  // Most of the time would be spent waiting for voxels from memory: request all of them first.
  std::vector<uint32_t> indices;
  indices.reserve(which.size());
  for (const uint32_t i : which) {
    indices.push_back(find_or_insert(samples[i].key));
    const auto* voxel = reinterpret_cast<const char*>(&voxels_[indices.back()]);
    __builtin_prefetch(voxel, 1);
    __builtin_prefetch(voxel + sizeof(Voxel) - 1, 1);
  }
  for (size_t i = 0; i < which.size(); ++i) mix(voxels_[indices[i]], samples[which[i]], view);
}

void VoxelGrid::add(const VoxelSample& sample, uint32_t view) {
  mix(voxels_[find_or_insert(sample.key)], sample, view);
}

const Voxel* VoxelGrid::find(VoxelKey key) const {
  if (table_.empty()) return nullptr;
  const uint32_t cell = table_[slot_of(cell_of(key))];
  if (cell == 0) return nullptr;
  const uint32_t voxel = cells_[cell - 1].voxel[place_in_cell(key)];
  return voxel == 0 ? nullptr : &voxels_[voxel - 1];
}

void VoxelGrid::erase_from(VoxelKey key) {
  std::erase_if(voxels_, [=](const Voxel& voxel) { return voxel.key >= key; });
  cells_.clear();
  std::fill(table_.begin(), table_.end(), 0);
  for (size_t i = 0; i < voxels_.size(); ++i) {
    cell_at(cell_of(voxels_[i].key)).voxel[place_in_cell(voxels_[i].key)] = static_cast<uint32_t>(i + 1);
  }
}

/// Index of the voxel, which is inserted if there is none.
uint32_t VoxelGrid::find_or_insert(VoxelKey key) {
  uint32_t& index = cell_at(cell_of(key)).voxel[place_in_cell(key)];
  if (index == 0) {
    reserve_one(voxels_);
    voxels_.emplace_back().key = key;
    index = static_cast<uint32_t>(voxels_.size());
  }
  return index - 1;
}

/// The cell with this corner, which is inserted if there is none.
VoxelGrid::Cell& VoxelGrid::cell_at(VoxelKey corner) {
  if (last_cell_ < cells_.size() && cells_[last_cell_].corner == corner) return cells_[last_cell_];
  // At most two thirds full, to keep probing short.
  if (3 * (cells_.size() + 1) > 2 * table_.size()) rebuild_table(std::max(kFirstTable, 2 * table_.size()));
  const size_t slot = slot_of(corner);
  if (table_[slot] == 0) {
    reserve_one(cells_);
    cells_.emplace_back().corner = corner;
    table_[slot] = static_cast<uint32_t>(cells_.size());
  }
  last_cell_ = table_[slot] - 1;
  return cells_[last_cell_];
}

/// Slot of the cell, or the free slot where it would be inserted.
size_t VoxelGrid::slot_of(VoxelKey corner) const {
  constexpr int kLowBits = 28;  // the lowest bits are hashed least, the highest select the grid
  const size_t mask = table_.size() - 1;
  size_t slot = (hash_key(corner) >> kLowBits) & mask;
  while (table_[slot] != 0 && cells_[table_[slot] - 1].corner != corner) slot = (slot + 1) & mask;
  return slot;
}

void VoxelGrid::rebuild_table(size_t size) {
  table_.assign(size, 0);
  for (size_t i = 0; i < cells_.size(); ++i) table_[slot_of(cells_[i].corner)] = static_cast<uint32_t>(i + 1);
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
