#include "tools/floor_plan/rooms.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#include <opencv2/imgproc/detail/gcgraph.hpp>
#pragma GCC diagnostic pop

#include "kinloop/core/disjoint_sets.hpp"

namespace kinloop {
namespace {

/// What is known of a cell.
struct CellEvidence {
  double free_m2 = 0, other_m2 = 0;
};

CellEvidence evidence_of(const PlanCell& cell, const cv::Mat& free_space, const PlanGrid& grid) {
  constexpr int kBits = 8;  // fraction of a pixel
  std::vector<cv::Point> corners;
  double area = 0;
  for (size_t i = 0; i < cell.sides.size(); ++i) {
    const Eigen::Vector2d p = (cell.sides[i].from_m - grid.origin_m) / grid.cell_m;
    corners.emplace_back(static_cast<int>(std::lround((p.x() - 0.5) * (1 << kBits))),
                         static_cast<int>(std::lround((p.y() - 0.5) * (1 << kBits))));
    area += cross(cell.sides[i].from_m, cell.end_m(i)) / 2;
  }
  std::vector<cv::Point> whole;
  for (const cv::Point& p : corners) whole.emplace_back(p.x >> kBits, p.y >> kBits);
  const cv::Rect frame = cv::boundingRect(whole) & cv::Rect({0, 0}, grid.size);
  if (frame.empty()) return {0, area};
  cv::Mat mask = cv::Mat::zeros(frame.size(), CV_8UC1);
  for (cv::Point& p : corners) p -= frame.tl() * (1 << kBits);
  cv::fillConvexPoly(mask, corners, 1, cv::LINE_8, kBits);
  const int all = cv::countNonZero(mask);
  if (all == 0) return {0, area};
  const int free = cv::countNonZero(free_space(frame).mul(mask));
  const double share = static_cast<double>(free) / all;
  return {share * area, (1 - share) * area};
}

class RoomCells {
 public:
  RoomCells(std::span<const WallLine> walls, const cv::Mat& free_space, const PlanGrid& grid)
      : walls_(walls) {
    std::vector<PlanLine> lines;
    for (const WallLine& wall : walls) lines.push_back(wall.line);
    const Eigen::Vector2d size_m = grid.cell_m * Eigen::Vector2d(grid.size.width, grid.size.height);
    cells_ = arrange(lines, {grid.origin_m, grid.origin_m + size_m});
    label(free_space, grid);
    part_rooms();
  }

  [[nodiscard]] std::vector<RoomShape> shapes() const {
    std::vector<RoomShape> rooms(cells_.size());
    std::vector<std::vector<bool>> done(cells_.size());
    for (size_t c = 0; c < cells_.size(); ++c) done[c].resize(cells_[c].sides.size(), false);
    for (size_t c = 0; c < cells_.size(); ++c) {
      for (size_t i = 0; i < cells_[c].sides.size(); ++i) {
        if (!inside_[c] || done[c][i] || !is_border(c, i)) continue;
        RoomOutline outline = simplified(trace(c, i, done));
        if (outline.size() < 3) continue;
        RoomShape& room = rooms[room_[c]];
        (kinloop::area_m2(outline) > 0 ? room.outer : room.inner.emplace_back()) = std::move(outline);
      }
    }
    std::erase_if(rooms, [](const RoomShape& room) { return room.outer.empty(); });
    return rooms;
  }

 private:
  /// Shares of a side on which surface was observed: as high as a wall, and of any height.
  struct Support {
    double high = 0, any = 0;
    bool continues = false;  ///< see WallLine
  };

  [[nodiscard]] Support support(size_t cell, size_t side) const {
    const CellSide& s = cells_[cell].sides[side];
    if (!s.line) return {};
    const WallLine& wall = walls_[*s.line];
    const double from_m = wall.line.along().dot(s.from_m),
                 to_m = wall.line.along().dot(cells_[cell].end_m(side));
    return {wall.support(from_m, to_m, wall.least_top_m), wall.support(from_m, to_m),
            wall.continues(from_m, to_m)};
  }

  /// Returns the cost of a metre of wall on a side, m2: small where there is surface as high as walls, larger
  /// on furniture, on the continuation of a wall and elsewhere.
  [[nodiscard]] double cost(size_t cell, size_t side) const {
    constexpr double kHigh = 0.02, kLow = 0.25, kContinued = 0.15, kUnobserved = 0.4;
    const Support found = support(cell, side);
    return found.high * kHigh + (found.any - found.high) * kLow +
           (1 - found.any) * (found.continues ? kContinued : kUnobserved);
  }

  [[nodiscard]] double length_m(size_t cell, size_t side) const {
    return (cells_[cell].end_m(side) - cells_[cell].sides[side].from_m).norm();
  }

  void label(const cv::Mat& free_space, const PlanGrid& grid) {
    constexpr double kNotSeen = 0.4;  // weight of area that was not seen free
    constexpr double kNever = 1e9;
    cv::detail::GCGraph<double> graph(static_cast<unsigned>(cells_.size()),
                                      static_cast<unsigned>(8 * cells_.size()));
    for (const PlanCell& cell : cells_) {
      const CellEvidence evidence = evidence_of(cell, free_space, grid);
      const bool at_border =
          std::any_of(cell.sides.begin(), cell.sides.end(), [](const CellSide& s) { return !s.line; });
      graph.addTermWeights(graph.addVtx(), evidence.free_m2,
                           at_border ? kNever : kNotSeen * evidence.other_m2);
    }
    for (size_t c = 0; c < cells_.size(); ++c) {
      for (size_t i = 0; i < cells_[c].sides.size(); ++i) {
        const auto other = cells_[c].sides[i].neighbor;
        if (!other || *other < c) continue;
        const double weight = length_m(c, i) * cost(c, i);
        graph.addEdges(static_cast<int>(c), static_cast<int>(*other), weight, weight);
      }
    }
    graph.maxFlow();
    for (size_t c = 0; c < cells_.size(); ++c) inside_.push_back(graph.inSourceSegment(static_cast<int>(c)));
  }

  /// Joins the cells inside across sides without surface as high as walls.
  void part_rooms() {
    constexpr double kOpen = 0.5;
    DisjointSets sets(cells_.size());
    for (size_t c = 0; c < cells_.size(); ++c) {
      for (size_t i = 0; i < cells_[c].sides.size(); ++i) {
        const auto other = cells_[c].sides[i].neighbor;
        if (other && inside_[c] && inside_[*other] && support(c, i).high < kOpen)
          sets.join(static_cast<uint32_t>(c), static_cast<uint32_t>(*other));
      }
    }
    for (size_t c = 0; c < cells_.size(); ++c) room_.push_back(sets.find(static_cast<uint32_t>(c)));
  }

  [[nodiscard]] bool is_border(size_t cell, size_t side) const {
    const auto other = cells_[cell].sides[side].neighbor;
    return !other || !inside_[*other] || room_[*other] != room_[cell];
  }

  /// Follows the border of a room, the room to the left.
  RoomOutline trace(size_t cell, size_t side, std::vector<std::vector<bool>>& done) const {
    RoomOutline outline;
    while (!done[cell][side]) {
      done[cell][side] = true;
      const CellSide& s = cells_[cell].sides[side];
      const Eigen::Vector2d way = (cells_[cell].end_m(side) - s.from_m).normalized();
      const Eigen::Vector2d normal(-way.y(), way.x());
      outline.push_back({s.from_m, {normal, normal.dot(s.from_m)}, support(cell, side).any});
      side = (side + 1) % cells_[cell].sides.size();
      while (!is_border(cell, side)) {  // turn about the corner into the next cell
        const size_t other = *cells_[cell].sides[side].neighbor;
        const auto back = std::find_if(cells_[other].sides.begin(), cells_[other].sides.end(),
                                       [&](const CellSide& t) { return t.neighbor == cell; });
        side = (static_cast<size_t>(back - cells_[other].sides.begin()) + 1) % cells_[other].sides.size();
        cell = other;
      }
    }
    return outline;
  }

  /// Joins sides on one line.
  static RoomOutline simplified(const RoomOutline& outline) {
    constexpr double kParallel = 1e-6;
    RoomOutline joined;
    std::vector<double> lengths_m;
    const auto is_same = [](const RoomSide& a, const RoomSide& b) {
      return std::abs(cross(a.line.normal, b.line.normal)) < kParallel &&
             a.line.normal.dot(b.line.normal) > 0;
    };
    const size_t n = outline.size();
    size_t start = 0;
    while (start < n && is_same(outline[start], outline[(start + n - 1) % n])) ++start;
    for (size_t k = 0; k < n; ++k) {
      const RoomSide& side = outline[(start + k) % n];
      const double length_m = (outline[(start + k + 1) % n].from_m - side.from_m).norm();
      if (joined.empty() || !is_same(joined.back(), side)) {
        joined.push_back(side);
        lengths_m.push_back(length_m);
        continue;
      }
      const double sum_m = lengths_m.back() + length_m;
      joined.back().observed = (joined.back().observed * lengths_m.back() + side.observed * length_m) / sum_m;
      lengths_m.back() = sum_m;
    }
    return joined;
  }

  std::span<const WallLine> walls_;
  std::vector<PlanCell> cells_;
  std::vector<bool> inside_;
  std::vector<size_t> room_;
};

}  // namespace

double area_m2(const RoomOutline& outline) {
  double sum = 0;
  for (size_t i = 0; i < outline.size(); ++i)
    sum += cross(outline[i].from_m, outline[(i + 1) % outline.size()].from_m) / 2;
  return sum;
}

double RoomShape::area_m2() const {
  double sum = kinloop::area_m2(outer);
  for (const RoomOutline& outline : inner) sum += kinloop::area_m2(outline);
  return sum;
}

std::vector<RoomShape> find_rooms(std::span<const WallLine> walls, const cv::Mat& free_space,
                                  const PlanGrid& grid) {
  constexpr double kSmallestRoom_m2 = 1;
  auto rooms = RoomCells(walls, free_space, grid).shapes();
  std::erase_if(rooms, [](const RoomShape& room) { return room.area_m2() < kSmallestRoom_m2; });
  std::stable_sort(rooms.begin(), rooms.end(),
                   [](const RoomShape& a, const RoomShape& b) { return a.area_m2() > b.area_m2(); });
  return rooms;
}

}  // namespace kinloop
