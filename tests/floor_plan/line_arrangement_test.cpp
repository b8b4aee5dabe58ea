#include <cmath>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "tools/floor_plan/rooms.hpp"

namespace kinloop {
namespace {

double area_m2(const PlanCell& cell) {
  double sum = 0;
  for (size_t i = 0; i < cell.sides.size(); ++i) sum += cross(cell.sides[i].from_m, cell.end_m(i)) / 2;
  return sum;
}

TEST(LineArrangement, RandomLinesDivideTheRectangleIntoConvexCells) {
  const Eigen::AlignedBox2d box(Eigen::Vector2d(-3, -2), Eigen::Vector2d(4, 5));
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    std::vector<PlanLine> lines;
    for (int i = 0; i < 12; ++i) {
      const double angle = random.uniform(0, 6.3);
      lines.push_back({{std::cos(angle), std::sin(angle)}, random.uniform(-2, 2)});
    }
    const auto cells = arrange(lines, box);
    double area = 0;
    for (const PlanCell& cell : cells) {
      area += area_m2(cell);
      for (size_t i = 0; i < cell.sides.size(); ++i) {
        const size_t next = (i + 1) % cell.sides.size();
        EXPECT_GT(cross(cell.end_m(i) - cell.sides[i].from_m, cell.end_m(next) - cell.end_m(i)), -1e-9);
      }
    }
    EXPECT_NEAR(area, 49, 1e-6);
  }
}

TEST(LineArrangement, EverySideOnALineHasACellBeyondThatSharesIt) {
  const Eigen::AlignedBox2d box(Eigen::Vector2d(0, 0), Eigen::Vector2d(10, 10));
  // Three lines through one point, and parallels.
  const std::vector<PlanLine> lines = {{{1, 0}, 5},
                                       {{0, 1}, 5},
                                       {{std::sqrt(0.5), std::sqrt(0.5)}, 10 * std::sqrt(0.5)},
                                       {{1, 0}, 6},
                                       {{0, 1}, 2}};
  const auto cells = arrange(lines, box);
  EXPECT_EQ(cells.size(), 13U);
  for (size_t c = 0; c < cells.size(); ++c) {
    for (size_t i = 0; i < cells[c].sides.size(); ++i) {
      const CellSide& side = cells[c].sides[i];
      ASSERT_EQ(side.line.has_value(), side.neighbor.has_value());
      if (!side.line) continue;
      const PlanCell& other = cells[*side.neighbor];
      size_t shared = 0;
      for (size_t k = 0; k < other.sides.size(); ++k) {
        if (other.sides[k].neighbor != c) continue;
        ++shared;
        EXPECT_LT((other.sides[k].from_m - cells[c].end_m(i)).norm(), 1e-9);
        EXPECT_LT((other.end_m(k) - side.from_m).norm(), 1e-9);
      }
      EXPECT_EQ(shared, 1U);
    }
  }
}

}  // namespace
}  // namespace kinloop
