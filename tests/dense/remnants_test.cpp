#include <algorithm>

#include <gtest/gtest.h>

#include "dense/cloud/space_carving.hpp"
#include "kinloop/core/random.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop {
namespace {

using Points = std::vector<Eigen::Vector3f>;

Points points_within(Random& random, size_t count, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  Points points(count);
  for (Eigen::Vector3f& point : points) point = test::uniform_vector<3>(random, low, high).cast<float>();
  return points;
}

std::vector<uint8_t> remnants(const Points& points, const std::vector<uint16_t>& surplus,
                              const Points& carved) {
  CarvedCells cells;
  for (const Eigen::Vector3f& point : carved) cells.add_carved(point);
  return find_remnants(points, surplus, cells);
}

size_t count_of(const std::vector<uint8_t>& marks) {
  return static_cast<size_t>(std::count(marks.begin(), marks.end(), 1));
}

/// A body 30 cm wide of which one point in ten is left, standing on a floor.
struct Room {
  Points floor, body, carved;

  explicit Room(uint64_t seed) {
    Random random(seed);
    floor = points_within(random, 4000, {-1, -1, 0}, {1, 1, 0.01});
    body = points_within(random, 200, {-0.15, -0.15, 0}, {0.15, 0.15, 1.7});
    carved = points_within(random, 2000, {-0.15, -0.15, 0}, {0.15, 0.15, 1.7});
  }
};

TEST(Remnants, NothingIsOneWhereNothingWasCarvedAway) {
  const Room room(1);
  EXPECT_EQ(count_of(remnants(room.floor, std::vector<uint16_t>(room.floor.size(), 0), {})), 0);
}

TEST(Remnants, WhatFewViewsSawAmongCarvedPointsIsOne) {
  const Room room(2);
  EXPECT_EQ(count_of(remnants(room.body, std::vector<uint16_t>(room.body.size(), 1), room.carved)),
            room.body.size());
}

TEST(Remnants, WhatManyViewsSawStays) {
  const Room room(3);
  EXPECT_EQ(count_of(remnants(room.body, std::vector<uint16_t>(room.body.size(), 20), room.carved)), 0);
}

TEST(Remnants, TheFloorUnderWhatMovedStays) {
  const Room room(4);
  Points points = room.floor;
  points.insert(points.end(), room.body.begin(), room.body.end());
  std::vector<uint16_t> surplus(room.floor.size(), 4);
  surplus.resize(points.size(), 0);
  const auto found = remnants(points, surplus, room.carved);
  EXPECT_EQ(std::count(found.begin(), found.begin() + static_cast<long>(room.floor.size()), 1), 0);
  EXPECT_GT(count_of(found), room.body.size() * 9 / 10);
}

TEST(Remnants, DoNotDependOnTheOrderOfPoints) {
  const Room room(5);
  Points points = room.body;
  points.insert(points.end(), room.floor.begin(), room.floor.end());
  Random random(6);
  std::vector<uint16_t> surplus(points.size());
  for (uint16_t& views : surplus) views = static_cast<uint16_t>(random.index(6));
  const auto found = remnants(points, surplus, room.carved);
  EXPECT_GT(count_of(found), 0);
  EXPECT_LT(count_of(found), points.size());

  std::reverse(points.begin(), points.end());
  std::reverse(surplus.begin(), surplus.end());
  auto reversed = remnants(points, surplus, room.carved);
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_EQ(found, reversed);
}

}  // namespace
}  // namespace kinloop
