#include "tools/floor_plan/drawing/draw_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace kinloop {
namespace {

constexpr DrawingColor kInk{38, 42, 48}, kPale{176, 180, 186}, kFloor{247, 244, 236}, kObject{221, 219, 212},
    kObjectEdge{170, 167, 158}, kPaper{255, 255, 255}, kMeasure{96, 102, 110}, kDoor{178, 120, 60};
constexpr double kWallThickness_m = 0.12;

/// Returns the angle by which to turn the plan so that its longest wall is parallel to an edge of the sheet.
double turn_of(const FloorPlan& plan) {
  constexpr double kQuarter = std::numbers::pi / 2;
  Eigen::Vector2d longest = Eigen::Vector2d::Zero();
  for (const PlanRoom& room : plan.rooms) {
    for (const PlanWall& wall : room.walls) {
      if (wall.length_m() > longest.norm()) longest = wall.to_m - wall.from_m;
    }
  }
  return -std::remainder(std::atan2(longest.y(), longest.x()), kQuarter);
}

Eigen::AlignedBox2d bounds_of(const FloorPlan& plan, const Eigen::Rotation2Dd& turn) {
  Eigen::AlignedBox2d box;
  for (const PlanRoom& room : plan.rooms) {
    for (const PlanWall& wall : room.walls) box.extend(turn * wall.from_m);
  }
  return box;
}

/// Where the plan lies on the sheet.
struct Placement {
  Eigen::Vector2d sheet_mm;
  int scale = 1;  ///< 1 : scale
  Eigen::Rotation2Dd turn{0};
  Eigen::Vector2d middle_m, middle_mm;

  [[nodiscard]] double mm(double m) const { return m * 1000 / scale; }
  [[nodiscard]] Eigen::Vector2d operator()(const Eigen::Vector2d& p_m) const {
    const Eigen::Vector2d p = turn * p_m - middle_m;
    return middle_mm + Eigen::Vector2d(mm(p.x()), -mm(p.y()));
  }
};

constexpr double kMargin_mm = 24, kFooter_mm = 14, kHeader_mm = 10;

/// Chooses the largest scale at which the plan fits on A4; at the smallest one, the sheet is as large as it
/// must be.
Placement place(const FloorPlan& plan) {
  constexpr std::array<int, 6> kScales = {20, 25, 50, 100, 200, 500};
  constexpr double kShort_mm = 210, kLong_mm = 297;
  Placement placement;
  placement.turn = Eigen::Rotation2Dd(turn_of(plan));
  Eigen::AlignedBox2d box = bounds_of(plan, placement.turn);
  const bool wide = box.sizes().x() > box.sizes().y();
  const Eigen::Vector2d around(2 * kMargin_mm, 2 * kMargin_mm + kHeader_mm + kFooter_mm);
  placement.sheet_mm = wide ? Eigen::Vector2d(kLong_mm, kShort_mm) : Eigen::Vector2d(kShort_mm, kLong_mm);
  for (const int scale : kScales) {
    placement.scale = scale;
    if ((box.sizes() * 1000 / scale + around - placement.sheet_mm).maxCoeff() <= 0) break;
  }
  placement.sheet_mm = placement.sheet_mm.cwiseMax(box.sizes() * 1000 / placement.scale + around);
  placement.middle_m = box.center();
  placement.middle_mm = placement.sheet_mm / 2 + Eigen::Vector2d(0, (kHeader_mm - kFooter_mm) / 2);
  return placement;
}

Eigen::Vector2d along(const PlanWall& wall) {
  return (wall.to_m - wall.from_m).normalized();
}

Eigen::Vector2d outwards(const PlanWall& wall) {
  const Eigen::Vector2d way = along(wall);
  return {way.y(), -way.x()};
}

/// Returns where the outer faces of two walls meet, the second following the first.
Eigen::Vector2d outer_corner(const PlanWall& first, const PlanWall& second) {
  constexpr double kNearlyStraight = 0.2;
  const Eigen::Vector2d a = outwards(first), b = outwards(second);
  const double sine = cross(along(first), along(second));
  if (std::abs(sine) < kNearlyStraight) return second.from_m + kWallThickness_m * a;
  return second.from_m + kWallThickness_m * (a + b) / (1 + a.dot(b));
}

class PlanDrawing {
 public:
  PlanDrawing(const FloorPlan& plan, const std::string& title) : plan_(plan), at_(place(plan)) {
    drawing_.size_mm = at_.sheet_mm;
    drawing_.title = title;
  }

  Drawing draw() {
    for (const PlanRoom& room : plan_.rooms) draw_walls(room);
    for (const PlanRoom& room : plan_.rooms) draw_floor(room);
    for (const PlanPolygon& object : plan_.objects) draw_object(object);
    for (const PlanRoom& room : plan_.rooms) {
      for (const PlanWall& wall : room.walls) {
        for (const PlanOpening& opening : wall.openings) draw_opening(wall, opening);
      }
    }
    for (size_t i = 0; i < plan_.rooms.size(); ++i) draw_measures(plan_.rooms[i], i + 1);
    draw_frame();
    return std::move(drawing_);
  }

 private:
  void area(const PlanPolygon& polygon_m, const DrawingColor& color) {
    std::vector<Eigen::Vector2d> points_mm;
    for (const Eigen::Vector2d& p : polygon_m) points_mm.push_back(at_(p));
    drawing_.area(std::move(points_mm), color);
  }
  void line(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, const DrawingColor& color,
            double width_mm, double dash_mm = 0) {
    drawing_.line({at_(from_m), at_(to_m)}, color, width_mm, dash_mm);
  }

  /// Returns the outline of a room and of each block that stands in it: ranges of its walls.
  static std::vector<std::pair<size_t, size_t>> outlines(const PlanRoom& room) {
    std::vector<std::pair<size_t, size_t>> ranges;
    size_t begin = 0;
    for (size_t i = 0; i < room.walls.size(); ++i) {
      const bool ends = i + 1 == room.walls.size() || room.walls[i].to_m != room.walls[i + 1].from_m;
      if (!ends) continue;
      ranges.emplace_back(begin, i + 1);
      begin = i + 1;
    }
    return ranges;
  }

  void draw_walls(const PlanRoom& room) {
    constexpr double kObserved = 0.3;
    for (const auto& [begin, end] : outlines(room)) {
      const size_t n = end - begin;
      for (size_t i = 0; i < n; ++i) {
        const PlanWall &before = room.walls[begin + (i + n - 1) % n], &wall = room.walls[begin + i],
                       &after = room.walls[begin + (i + 1) % n];
        area({wall.from_m, wall.to_m, outer_corner(wall, after), outer_corner(before, wall)},
             wall.observed < kObserved ? kPale : kInk);
      }
    }
  }

  void draw_floor(const PlanRoom& room) {
    for (const auto& [begin, end] : outlines(room)) {
      PlanPolygon polygon;
      for (size_t i = begin; i < end; ++i) polygon.push_back(room.walls[i].from_m);
      area(polygon, begin == 0 ? kFloor : kInk);
    }
  }

  void draw_object(const PlanPolygon& polygon) {
    constexpr double kEdge_mm = 0.15;
    area(polygon, kObject);
    std::vector<Eigen::Vector2d> edge_mm;
    for (const Eigen::Vector2d& p : polygon) edge_mm.push_back(at_(p));
    edge_mm.push_back(edge_mm.front());
    drawing_.line(std::move(edge_mm), kObjectEdge, kEdge_mm);
  }

  void draw_opening(const PlanWall& wall, const PlanOpening& opening) {
    constexpr double kThin_mm = 0.25;
    const Eigen::Vector2d a = wall.from_m + opening.begin_m * along(wall),
                          b = wall.from_m + opening.end_m * along(wall), out = outwards(wall);
    const Eigen::Vector2d depth = kWallThickness_m * out;
    area({a, b, b + depth, a + depth}, kPaper);
    line(a, a + depth, kInk, kThin_mm);
    line(b, b + depth, kInk, kThin_mm);
    if (opening.kind == OpeningKind::kHole) {
      for (const double share : {0.0, 0.5, 1.0}) line(a + share * depth, b + share * depth, kInk, kThin_mm);
    } else {
      line(a, b, kMeasure, kThin_mm, 1);
    }
    constexpr double kText_mm = 2.4, kInside_mm = 3.4;
    const Eigen::Vector2d middle = at_((a + b) / 2), in = (at_(a - out) - at_(a)).normalized();
    label(middle + kInside_mm * in, a, b, fmt::format("{:.2f}", opening.end_m - opening.begin_m), kText_mm,
          kDoor);
  }

  /// Writes along the line from `a` to `b`, so that it can be read from below or from the right.
  void label(const Eigen::Vector2d& middle_mm, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m,
             const std::string& text, double size_mm, const DrawingColor& color) {
    constexpr double kQuarter = std::numbers::pi / 2, kSlack = 1e-3, kHalfLetter = 0.35;
    const Eigen::Vector2d way = at_(b_m) - at_(a_m);
    double angle = std::atan2(-way.y(), way.x());
    if (angle > kQuarter + kSlack) angle -= 2 * kQuarter;
    if (angle <= -kQuarter + kSlack) angle += 2 * kQuarter;
    // Down on the sheet, across the text: the base line is below the middle of the letters.
    const Eigen::Vector2d down(std::sin(angle), std::cos(angle));
    drawing_.text(middle_mm + kHalfLetter * size_mm * down, text, size_mm, angle, color);
  }

  /// Draws the length of a wall outside of it.
  void draw_length(const PlanWall& wall) {
    constexpr double kShortest_m = 0.25, kDistance_mm = 4, kTick_mm = 1.2, kThin_mm = 0.15, kText_mm = 3,
                     kTextDistance_mm = 2.2;
    if (wall.length_m() < kShortest_m) return;
    const Eigen::Vector2d a = at_(wall.from_m), b = at_(wall.to_m);
    const Eigen::Vector2d way = (b - a).normalized();
    const Eigen::Vector2d out = (at_(wall.from_m + outwards(wall)) - a).normalized();
    const Eigen::Vector2d shift = (at_.mm(kWallThickness_m) + kDistance_mm) * out;
    drawing_.line({a + shift, b + shift}, kMeasure, kThin_mm);
    for (const Eigen::Vector2d& end : {a, b}) {
      const Eigen::Vector2d at = end + shift;
      drawing_.line({at - kTick_mm * out, at + kTick_mm * out}, kMeasure, kThin_mm);
      drawing_.line({at - kTick_mm / 2 * (way - out), at + kTick_mm / 2 * (way - out)}, kMeasure,
                    2 * kThin_mm);
    }
    label((a + b) / 2 + shift + kTextDistance_mm * out, wall.from_m, wall.to_m,
          fmt::format("{:.2f}", wall.length_m()), kText_mm, kInk);
  }

  /// Returns the point of a room that is farthest from its walls and from what stands in it.
  [[nodiscard]] Eigen::Vector2d label_place(const PlanRoom& room) const {
    constexpr double kStep_m = 0.05;
    const Placement& at = at_;
    Eigen::AlignedBox2d box;
    for (const PlanWall& wall : room.walls) box.extend(at.turn * wall.from_m);
    const cv::Size size(static_cast<int>(box.sizes().x() / kStep_m) + 3,
                        static_cast<int>(box.sizes().y() / kStep_m) + 3);
    const auto pixel = [&](const Eigen::Vector2d& p_m) {
      const Eigen::Vector2d p = (at.turn * p_m - box.min()) / kStep_m;
      return cv::Point(static_cast<int>(std::lround(p.x())) + 1, static_cast<int>(std::lround(p.y())) + 1);
    };
    cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
    std::vector<std::vector<cv::Point>> polygons;
    for (const auto& [begin, end] : outlines(room)) {
      auto& polygon = polygons.emplace_back();
      for (size_t i = begin; i < end; ++i) polygon.push_back(pixel(room.walls[i].from_m));
    }
    cv::fillPoly(mask, polygons, 255);
    for (const PlanPolygon& object : plan_.objects) {
      std::vector<cv::Point> polygon;
      for (const Eigen::Vector2d& p : object) polygon.push_back(pixel(p));
      cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{polygon}, 0);
    }
    cv::Mat distance;
    cv::distanceTransform(mask, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    cv::Point best;
    cv::minMaxLoc(distance, nullptr, nullptr, nullptr, &best);
    return at.turn.inverse() * (box.min() + kStep_m * Eigen::Vector2d(best.x - 1, best.y - 1));
  }

  void draw_measures(const PlanRoom& room, size_t number) {
    constexpr double kName_mm = 4.2, kArea_mm = 3.6, kHeight_mm = 2.8;
    for (const PlanWall& wall : room.walls) draw_length(wall);
    const Eigen::Vector2d middle = at_(label_place(room));
    if (plan_.rooms.size() > 1)
      drawing_.text(middle - Eigen::Vector2d(0, kName_mm), fmt::format("Room {}", number), kName_mm, 0, kInk);
    drawing_.text(middle + Eigen::Vector2d(0, 0.3 * kArea_mm), fmt::format("{:.2f} m²", room.area_m2),
                  kArea_mm, 0, kInk);
    if (!plan_.ceiling_m) return;
    drawing_.text(middle + Eigen::Vector2d(0, 1.6 * kArea_mm),
                  fmt::format("height {:.2f} m", *plan_.ceiling_m), kHeight_mm, 0, kMeasure);
  }

  /// Draws the title, the scale, and what the colours mean.
  void draw_frame() {
    constexpr double kEdge_mm = 10, kTitle_mm = 5, kText_mm = 2.8, kBar_mm = 1.2;
    const Eigen::Vector2d size = at_.sheet_mm;
    drawing_.text({size.x() / 2, kEdge_mm + kTitle_mm}, drawing_.title, kTitle_mm, 0, kInk);
    const double y = size.y() - kEdge_mm - kText_mm;
    for (int i = 0; i < 4; ++i) {
      const double step = at_.mm(at_.scale > 100 ? 5 : 1) / 2, x = kEdge_mm + i * step;
      drawing_.area({{x, y - kBar_mm}, {x + step, y - kBar_mm}, {x + step, y}, {x, y}},
                    i % 2 == 0 ? kInk : kPale);
    }
    const double bar_m = at_.scale > 100 ? 10 : 2;
    drawing_.text({kEdge_mm + at_.mm(bar_m) / 2, y + 1.4 * kText_mm},
                  fmt::format("{} m, scale 1 : {}", bar_m, at_.scale), kText_mm, 0, kMeasure);
    drawing_.text({size.x() / 2 + at_.mm(bar_m) / 2, y + 1.4 * kText_mm},
                  "lengths in metres; pale walls were not observed; by kinloop", kText_mm, 0, kMeasure);
  }

  const FloorPlan& plan_;
  Placement at_;
  Drawing drawing_;
};

}  // namespace

Drawing draw_plan(const FloorPlan& plan, const std::string& title) {
  return PlanDrawing(plan, title).draw();
}

}  // namespace kinloop
