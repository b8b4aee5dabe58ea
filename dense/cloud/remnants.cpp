#include <cmath>

#include "dense/cloud/space_carving.hpp"
#include "dense/surfels/voxel_samples.hpp"

namespace kinloop {
namespace {

constexpr float kCell_m = 0.16F;

// A view more or less changes the odds by this factor, as a logarithm: views of one point are not
// independent. The cells, this and the passes were chosen on simulated rooms with and without people (seeds
// 101 to 103). With them 0.2 to 0.3 % of the points left are where people walked, without 1.1 to 1.3 % (101,
// 102).
constexpr float kLogOddsPerView = 0.5F;

// Remnants that are found make those beside them stand out.
constexpr int kPasses = 3;

}  // namespace

CarvedCells::Key CarvedCells::key_of(const Eigen::Vector3f& p_world) {
  const Eigen::Vector3i cell = (p_world / kCell_m).array().floor().cast<int>();
  return {cell.x(), cell.y(), cell.z()};
}

size_t CarvedCells::Hash::operator()(const Key& key) const {
  return hash_key(voxel_key(key[0], key[1], key[2]));
}

void CarvedCells::carve(const Eigen::Vector3f& p_world) {
  Cell& cell = at(p_world);
  --cell.left;
  ++cell.carved;
}

void CarvedCells::update_log_odds() {
  for (auto& [key, cell] : cells_) {
    uint32_t left = 0, carved = 0;
    for (int i = 0; i < 27; ++i) {
      const auto found = cells_.find({key[0] + i % 3 - 1, key[1] + i / 3 % 3 - 1, key[2] + i / 9 - 1});
      if (found == cells_.end()) continue;
      left += found->second.left;
      carved += found->second.carved;
    }
    constexpr float kUnknown = 0.5F;  // a cell without points tells nothing
    cell.log_odds = std::log((static_cast<float>(left) + kUnknown) / (static_cast<float>(carved) + kUnknown));
  }
}

float CarvedCells::log_odds(const Eigen::Vector3f& p_world) const {
  return cells_.at(key_of(p_world)).log_odds;
}

std::vector<uint8_t> find_remnants(std::span<const Eigen::Vector3f> points, std::span<const uint16_t> surplus,
                                   CarvedCells& cells) {
  for (const Eigen::Vector3f& point : points) cells.add_left(point);
  std::vector<uint8_t> is_remnant(points.size(), 0);
  for (int pass = 0; pass < kPasses; ++pass) {
    cells.update_log_odds();
    for (size_t i = 0; i < points.size(); ++i) {
      if (is_remnant[i] != 0 || cells.log_odds(points[i]) + kLogOddsPerView * surplus[i] >= 0) continue;
      is_remnant[i] = 1;
      cells.carve(points[i]);
    }
  }
  return is_remnant;
}

}  // namespace kinloop
