#include "tools/floor_plan/wall_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace kinloop {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Votes of oriented points for lines (Duda and Hart 1972), by direction of the normal and offset.
class LineVotes {
 public:
  explicit LineVotes(std::span<const UprightPoint> points) {
    for (const UprightPoint& point : points) reach_m_ = std::max(reach_m_, point.p_m.norm());
    reach_m_ += 1;
    offsets_ = static_cast<size_t>(std::ceil(2 * reach_m_ / kOffsetStep_m)) + 1;
    votes_.assign(kDirections * offsets_, 0);
  }

  /// Votes for the lines through a point whose normals are near its own.
  void vote(const UprightPoint& point, int weight) {
    const int own = static_cast<int>(std::lround(std::atan2(point.normal.y(), point.normal.x()) / kDegree));
    for (int direction = own - kNear; direction <= own + kNear; ++direction) {
      const auto wrapped = static_cast<size_t>((direction + kDirections) % kDirections);
      const double offset_m = normal_of(wrapped).dot(point.p_m);
      votes_[wrapped * offsets_ + static_cast<size_t>((offset_m + reach_m_) / kOffsetStep_m)] += weight;
    }
  }

  /// Returns the line with most votes, and their number.
  [[nodiscard]] std::pair<PlanLine, int> best() const {
    const auto most = std::max_element(votes_.begin(), votes_.end());
    const auto index = static_cast<size_t>(most - votes_.begin());
    const double bin = static_cast<double>(index % offsets_);
    return {{normal_of(index / offsets_), (bin + 0.5) * kOffsetStep_m - reach_m_}, *most};
  }

 private:
  static constexpr int kDirections = 360, kNear = 8;
  static constexpr double kOffsetStep_m = 0.03;

  static Eigen::Vector2d normal_of(size_t direction) {
    const double angle = static_cast<double>(direction) * kDegree;
    return {std::cos(angle), std::sin(angle)};
  }

  double reach_m_ = 0;
  size_t offsets_ = 0;
  std::vector<int> votes_;
};

/// Returns the direction of the normals, modulo 90 degrees, that most points are near to.
double main_direction_rad(std::span<const UprightPoint> points) {
  constexpr size_t kBins = 360;
  constexpr double kQuarter = std::numbers::pi / 2;
  std::vector<double> counts(kBins, 0);
  for (const UprightPoint& point : points) {
    const double angle = std::atan2(point.normal.y(), point.normal.x()) + 4 * kQuarter;
    ++counts[static_cast<size_t>(std::fmod(angle, kQuarter) / kQuarter * kBins) % kBins];
  }
  constexpr int kSmooth = 12;  // bins to either side: 3 degrees
  double best = 0, sum_best = -1;
  for (int bin = 0; bin < static_cast<int>(kBins); ++bin) {
    double sum = 0, shift = 0;
    for (int k = -kSmooth; k <= kSmooth; ++k) {
      const double count = counts[static_cast<size_t>((bin + k + static_cast<int>(kBins))) % kBins];
      sum += count;
      shift += count * k;
    }
    if (sum <= sum_best) continue;
    sum_best = sum;
    best = (bin + 0.5 + shift / std::max(sum, 1.0)) / kBins * kQuarter;
  }
  return best;
}

/// Fits a line to the points near `start` by total least squares with Tukey's weights.
PlanLine fit(std::span<const UprightPoint> points, const PlanLine& start) {
  constexpr double kReach_m = 0.05, kLargestTurn = 0.94;  // cosine of 20 degrees
  constexpr int kIterations = 6;
  PlanLine line = start;
  for (int i = 0; i < kIterations; ++i) {
    double weight = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    for (const UprightPoint& point : points) {
      const double ratio = line.distance_m(point.p_m) / kReach_m;
      if (std::abs(ratio) >= 1 || point.normal.dot(line.normal) < kLargestTurn) continue;
      const double w = (1 - ratio * ratio) * (1 - ratio * ratio);
      weight += w;
      sum += w * point.p_m;
      squares += w * point.p_m * point.p_m.transpose();
    }
    if (weight < 3) break;
    const Eigen::Vector2d mean = sum / weight;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(squares / weight - mean * mean.transpose());
    Eigen::Vector2d normal = solver.eigenvectors().col(0);
    if (normal.dot(start.normal) < 0) normal = -normal;
    if (normal.dot(start.normal) < kLargestTurn) break;
    line = {normal, normal.dot(mean)};
  }
  return line;
}

/// Turns the normal to the nearest of four perpendicular directions if that moves no end of a wall of
/// `length_m` much.
PlanLine aligned(const PlanLine& line, double main_rad, double length_m, const Eigen::Vector2d& pivot_m) {
  constexpr double kQuarter = std::numbers::pi / 2, kLargestShift_m = 0.05, kLargestTurn_rad = 3 * kDegree;
  const double angle = std::atan2(line.normal.y(), line.normal.x());
  const double turn = std::remainder(main_rad - angle, kQuarter);
  if (std::abs(turn) > kLargestTurn_rad || std::abs(turn) * length_m / 2 > kLargestShift_m) return line;
  const Eigen::Vector2d normal(std::cos(angle + turn), std::sin(angle + turn));
  return {normal, normal.dot(pivot_m)};
}

/// Returns the offset of the wall among what hangs on it: the layer farthest from the seen side that has a
/// good share of the surface of the largest one.
double wall_offset_m(std::span<const UprightPoint> points, const PlanLine& line) {
  constexpr double kReach_m = 0.08, kBin_m = 0.004, kShare = 0.3;
  constexpr int kSpread = 2, kBins = static_cast<int>(2 * kReach_m / kBin_m);
  std::vector<double> counts(kBins, 0), sums(kBins, 0);
  for (const UprightPoint& point : points) {
    const double distance_m = line.distance_m(point.p_m);
    if (std::abs(distance_m) >= kReach_m) continue;
    const auto bin = static_cast<size_t>((distance_m + kReach_m) / kBin_m);
    ++counts[bin];
    sums[bin] += distance_m;
  }
  const auto window = [&](const std::vector<double>& values, int middle) {
    double sum = 0;
    for (int k = std::max(middle - kSpread, 0); k <= std::min(middle + kSpread, kBins - 1); ++k)
      sum += values[static_cast<size_t>(k)];
    return sum;
  };
  double most = 0;
  for (int bin = 0; bin < kBins; ++bin) most = std::max(most, window(counts, bin));
  if (most == 0) return line.offset_m;
  for (int bin = 0; bin < kBins; ++bin) {
    const double here = window(counts, bin);
    if (here < kShare * most) continue;
    if (bin + 1 < kBins && window(counts, bin + 1) > here) continue;  // still rising
    return line.offset_m + window(sums, bin) / here;
  }
  return line.offset_m;
}

/// Returns the candidate that stands on the line, and removes its points.
WallLine take(std::vector<UprightPoint>& points, const PlanLine& line, double point_area_m2,
              LineVotes& votes) {
  constexpr double kBehind_m = 0.05, kBefore_m = 0.06, kLargestTurn = 0.87;  // cosine of 30 degrees
  constexpr double kLayer_m = 0.1;
  const auto is_on = [&](const UprightPoint& point) {
    const double distance_m = line.distance_m(point.p_m);
    return distance_m > -kBehind_m && distance_m < kBefore_m && point.normal.dot(line.normal) > kLargestTurn;
  };
  const auto on = std::partition(points.begin(), points.end(), [&](const auto& p) { return !is_on(p); });
  WallLine wall{line, static_cast<double>(points.end() - on) * point_area_m2, 0, {}};
  if (on == points.end()) return wall;
  double low_m = line.along().dot(on->p_m), high_m = low_m;
  for (auto p = on; p != points.end(); ++p) {
    const double s_m = line.along().dot(p->p_m);
    low_m = std::min(low_m, s_m), high_m = std::max(high_m, s_m);
  }
  wall.first_m = low_m;
  const size_t steps = static_cast<size_t>((high_m - low_m) / kWallStep_m) + 1;
  std::vector<std::vector<uint8_t>> layers(steps);
  for (auto p = on; p != points.end(); ++p) {
    auto& column = layers[static_cast<size_t>((line.along().dot(p->p_m) - low_m) / kWallStep_m)];
    const auto layer = static_cast<size_t>(std::max(0.0, p->z_m / kLayer_m));
    if (layer >= column.size()) column.resize(layer + 1, 0);
    column[layer] = 1;
    votes.vote(*p, -1);
  }
  for (const auto& column : layers) {
    wall.columns.push_back({kLayer_m * static_cast<double>(std::count(column.begin(), column.end(), 1)),
                            kLayer_m * static_cast<double>(column.size())});
  }
  points.erase(on, points.end());
  return wall;
}

/// Returns how far the surface of a line is before another one, if it is nearly parallel to it and both are
/// at the same place.
std::optional<double> distance_before(const WallLine& front, const WallLine& wall) {
  constexpr double kParallel = 0.87;  // cosine of 30 degrees
  if (front.line.normal.dot(wall.line.normal) < kParallel) return std::nullopt;
  double sum_m = 0, count = 0, low_m = 0, high_m = 0;
  for (size_t i = 0; i < front.columns.size(); ++i) {
    if (front.columns[i].observed_m < kLeastObserved_m) continue;
    const Eigen::Vector2d p = front.line.at(front.first_m + (static_cast<double>(i) + 0.5) * kWallStep_m);
    const double s_m = wall.line.along().dot(p);
    low_m = count == 0 ? s_m : std::min(low_m, s_m);
    high_m = count == 0 ? s_m : std::max(high_m, s_m);
    sum_m += wall.line.distance_m(p);
    ++count;
  }
  if (count == 0 || !wall.continues(low_m, high_m)) return std::nullopt;
  return sum_m / count;
}

/// Returns the middle and the length of the points near the line, without the outermost.
std::pair<Eigen::Vector2d, double> extent(std::span<const UprightPoint> points, const PlanLine& line) {
  constexpr double kReach_m = 0.05, kLargestTurn = 0.94, kOutermost = 0.02;
  std::vector<double> positions_m;
  for (const UprightPoint& point : points) {
    if (std::abs(line.distance_m(point.p_m)) < kReach_m && point.normal.dot(line.normal) > kLargestTurn)
      positions_m.push_back(line.along().dot(point.p_m));
  }
  if (positions_m.empty()) return {line.at(0), 0};
  std::sort(positions_m.begin(), positions_m.end());
  const auto left_out = static_cast<size_t>(kOutermost * static_cast<double>(positions_m.size()));
  const double low_m = positions_m[left_out], high_m = positions_m[positions_m.size() - 1 - left_out];
  return {line.at((low_m + high_m) / 2), high_m - low_m};
}

}  // namespace

double WallLine::support(double from_m, double to_m, double reaching_m) const {
  if (from_m > to_m) std::swap(from_m, to_m);
  int all = 0, supported = 0;
  for (double s_m = from_m + kWallStep_m / 2; s_m < to_m; s_m += kWallStep_m) {
    ++all;
    const double step = std::floor((s_m - first_m) / kWallStep_m);
    if (step < 0 || step >= static_cast<double>(columns.size())) continue;
    const WallColumn& column = columns[static_cast<size_t>(step)];
    if (column.observed_m >= kLeastObserved_m && column.top_m >= reaching_m) ++supported;
  }
  return all == 0 ? 0 : static_cast<double>(supported) / all;
}

bool WallLine::continues(double from_m, double to_m) const {
  constexpr double kReach_m = 1;
  const auto is_observed = [](const WallColumn& column) { return column.observed_m >= kLeastObserved_m; };
  const auto first = std::find_if(columns.begin(), columns.end(), is_observed) - columns.begin();
  const auto last = columns.rend() - std::find_if(columns.rbegin(), columns.rend(), is_observed);
  const double begin_m = first_m + kWallStep_m * static_cast<double>(first);
  const double end_m = first_m + kWallStep_m * static_cast<double>(last);
  return std::max(from_m, to_m) > begin_m - kReach_m && std::min(from_m, to_m) < end_m + kReach_m;
}

std::vector<WallLine> find_wall_lines(std::span<const UprightPoint> all_points, double point_area_m2) {
  constexpr double kLeastArea_m2 = 0.3;
  constexpr size_t kMostLines = 60;
  std::vector<UprightPoint> points(all_points.begin(), all_points.end());
  const double main_rad = main_direction_rad(points);
  LineVotes votes(points);
  for (const UprightPoint& point : points) votes.vote(point, 1);
  std::vector<WallLine> walls;
  while (walls.size() < kMostLines && !points.empty()) {
    const auto [start, count] = votes.best();
    if (count * point_area_m2 < kLeastArea_m2) break;
    PlanLine line = fit(points, start);
    const auto [pivot_m, length_m] = extent(points, line);
    line = aligned(line, main_rad, length_m, pivot_m);
    line.offset_m = wall_offset_m(points, line);
    const size_t before = points.size();
    WallLine wall = take(points, line, point_area_m2, votes);
    if (points.size() == before) break;
    if (wall.area_m2 >= kLeastArea_m2) walls.push_back(std::move(wall));
  }
  return walls;
}

std::vector<WallLine> without_furniture(std::vector<WallLine> lines, double highest_m,
                                        std::optional<double> ceiling_m) {
  constexpr double kLarger = 1.5, kBehind_m = -0.06, kHanging_m = 0.15, kStanding_m = 0.8, kShort_m = 0.3;
  std::stable_sort(lines.begin(), lines.end(),
                   [](const WallLine& a, const WallLine& b) { return a.area_m2 > b.area_m2; });
  std::vector<WallLine> kept;
  for (WallLine& line : lines) {
    line.least_top_m = highest_m - kShort_m;
    bool hangs = false;
    for (const WallLine& wall : kept) {
      const auto before_m = distance_before(line, wall);
      if (!before_m || wall.area_m2 < kLarger * line.area_m2) continue;
      hangs = hangs || (*before_m > kBehind_m && *before_m < kHanging_m);
      if (*before_m >= kHanging_m && *before_m < kStanding_m)
        line.least_top_m = ceiling_m.value_or(std::numeric_limits<double>::infinity()) - kShort_m;
    }
    if (!hangs) kept.push_back(std::move(line));
  }
  return kept;
}

}  // namespace kinloop
