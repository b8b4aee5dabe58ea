#include "simulator/render/bvh.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "simulator/render/ray_spans.hpp"

namespace kinloop::sim {
namespace {

constexpr size_t kLeafSize = 2;
constexpr int kMaxDepth = 64;

float half_area(const Eigen::AlignedBox3f& box) {
  const Eigen::Vector3f size = box.sizes();
  return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
}

struct Split {
  float cost = std::numeric_limits<float>::infinity();
  int axis = 0;
  size_t position = 0;
};

using Boxes = std::vector<Eigen::AlignedBox3f>;

void sort_along(std::vector<int32_t>& order, size_t begin, size_t end, int axis, const Boxes& boxes) {
  const auto center = [&](int32_t i) { return boxes[static_cast<size_t>(i)].center()[axis]; };
  std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(begin),
                   order.begin() + static_cast<std::ptrdiff_t>(end),
                   [&](int32_t a, int32_t b) { return center(a) < center(b); });
}

/// The split of [begin, end) with the least expected number of solids to test.
Split best_split(std::vector<int32_t>& order, size_t begin, size_t end, const Boxes& boxes) {
  Split best;
  std::vector<float> right_area(end - begin);
  for (int axis = 0; axis < 3; ++axis) {
    sort_along(order, begin, end, axis, boxes);
    Eigen::AlignedBox3f right;
    for (size_t i = end; i-- > begin;) {
      right.extend(boxes[static_cast<size_t>(order[i])]);
      right_area[i - begin] = half_area(right);
    }
    Eigen::AlignedBox3f left;
    for (size_t i = begin + 1; i < end; ++i) {
      left.extend(boxes[static_cast<size_t>(order[i - 1])]);
      const float cost = half_area(left) * static_cast<float>(i - begin) +
                         right_area[i - begin] * static_cast<float>(end - i);
      if (cost < best.cost) best = {cost, axis, i};
    }
  }
  return best;
}

constexpr float kMissed = std::numeric_limits<float>::infinity();

struct Interval {
  float low, high;
};

Interval reduced(Lanes low, Lanes high) {
  return {std::min(std::min(low[0], low[1]), std::min(low[2], low[3])),
          std::max(std::max(high[0], high[1]), std::max(high[2], high[3]))};
}

/// A bundle as one interval per axis.
struct Intervals {
  Interval origin[3], direction[3];

  explicit Intervals(const RayBundle& b)
      : origin{reduced(b.origin_low.x, b.origin_high.x), reduced(b.origin_low.y, b.origin_high.y),
               reduced(b.origin_low.z, b.origin_high.z)},
        direction{reduced(b.direction_low.x, b.direction_high.x),
                  reduced(b.direction_low.y, b.direction_high.y),
                  reduced(b.direction_low.z, b.direction_high.z)} {}
};

/// Bounds on when rays with origins and directions in intervals stay within [low, high] of one axis: earliest
/// entry and latest exit (interval arithmetic as in Boulos et al. 2006, "Geometric and arithmetic culling
/// methods for entire ray packets").
struct RayInterval {
  float enter, leave;
};

RayInterval axis_interval(Interval origin, Interval d, float low, float high) {
  if (d.high < 0) return axis_interval({-origin.high, -origin.low}, {-d.high, -d.low}, -high, -low);
  const float near = low - origin.high, far = high - origin.low;
  if (d.low > 0) return {near / (near > 0 ? d.high : d.low), far / (far > 0 ? d.low : d.high)};
  // Directions of both signs: a ray parallel to the slab never leaves it.
  if (near > 0) return {near / d.high, kMissed};
  const float below = origin.low - high;
  return {below > 0 ? below / -d.low : 0, kMissed};
}

/// The least t at which a ray of the bundle may be in a box; kMissed if none can.
float min_entry(const Intervals& bundle, const float low[3], const float high[3]) {
  RayInterval all{0, kMissed};
  for (int i = 0; i < 3; ++i) {
    const RayInterval stay = axis_interval(bundle.origin[i], bundle.direction[i], low[i], high[i]);
    all = {std::max(all.enter, stay.enter), std::min(all.leave, stay.leave)};
  }
  return all.enter <= all.leave ? all.enter : kMissed;
}

}  // namespace

Bvh::Bvh(const std::vector<Primitive>& primitives) {
  Boxes boxes;
  boxes.reserve(primitives.size());
  for (const Primitive& primitive : primitives) boxes.push_back(bounds(primitive));
  std::vector<int32_t> order(primitives.size());
  std::iota(order.begin(), order.end(), 0);
  if (!primitives.empty()) build(order, 0, order.size(), boxes, primitives, 0);
}

Bvh::Solid Bvh::packed(const Primitive& primitive, int32_t index) {
  Solid solid{};
  const Eigen::Matrix3f& R = primitive.R_room_local;
  Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(solid.R_local_room) = R.transpose();
  Eigen::Map<Eigen::Vector3f>(solid.center) = primitive.center;
  Eigen::Map<Eigen::Vector3f>(solid.half) = primitive.half;
  solid.shape = primitive.shape;
  solid.primitive = index;
  // Quarter turns leave tiny rounding errors, far below the resolution of a depth image.
  constexpr float kRounding = 1e-6F;
  const Eigen::Matrix3f axes = R.cwiseAbs().array().round();
  solid.aligned = primitive.shape == Shape::kBox && (R.cwiseAbs() - axes).cwiseAbs().maxCoeff() < kRounding;
  if (solid.aligned) Eigen::Map<Eigen::Vector3f>(solid.half) = axes * primitive.half;
  return solid;
}

int32_t Bvh::build(std::vector<int32_t>& order, size_t begin, size_t end, const Boxes& boxes,
                   const std::vector<Primitive>& primitives, int depth) {
  const auto index = static_cast<int32_t>(nodes_.size());
  Eigen::AlignedBox3f box;
  for (size_t i = begin; i < end; ++i) box.extend(boxes[static_cast<size_t>(order[i])]);
  Node node{};
  // Slightly larger than the solids, so that the rounding of the slab test does not lose a ray that just
  // touches.
  constexpr float kSlack = 1e-5F;
  Eigen::Map<Eigen::Vector3f>(node.low) = box.min().array() - kSlack;
  Eigen::Map<Eigen::Vector3f>(node.high) = box.max().array() + kSlack;
  nodes_.push_back(node);
  if (end - begin <= kLeafSize) {
    nodes_[static_cast<size_t>(index)].first = static_cast<int32_t>(solids_.size());
    nodes_[static_cast<size_t>(index)].count = static_cast<int32_t>(end - begin);
    for (size_t i = begin; i < end; ++i) {
      solids_.push_back(packed(primitives[static_cast<size_t>(order[i])], order[i]));
    }
    return index;
  }
  Split split = best_split(order, begin, end, boxes);
  if (depth >= kMaxDepth / 2) split.position = begin + (end - begin) / 2;  // halving bounds the depth
  sort_along(order, begin, end, split.axis, boxes);
  build(order, begin, split.position, boxes, primitives, depth + 1);
  const int32_t right = build(order, split.position, end, boxes, primitives, depth + 1);
  nodes_[static_cast<size_t>(index)].first = right;
  nodes_[static_cast<size_t>(index)].axis = split.axis;
  return index;
}

void Bvh::intersect(const Solid& solid, const RayPacket& rays, const Lanes3& inverse, HitPacket& hits) {
  const Lanes3 p{rays.origin.x - solid.center[0], rays.origin.y - solid.center[1],
                 rays.origin.z - solid.center[2]};
  Span span{};
  if (solid.aligned) {
    span = box_span(p, inverse, solid.half);
  } else {
    const float* R = solid.R_local_room;
    const Lanes3& v = rays.direction;
    const Lanes3 o{R[0] * p.x + R[1] * p.y + R[2] * p.z, R[3] * p.x + R[4] * p.y + R[5] * p.z,
                   R[6] * p.x + R[7] * p.y + R[8] * p.z};
    const Lanes3 d{R[0] * v.x + R[1] * v.y + R[2] * v.z, R[3] * v.x + R[4] * v.y + R[5] * v.z,
                   R[6] * v.x + R[7] * v.y + R[8] * v.z};
    if (solid.shape == Shape::kBox) span = box_span(o, safe_inverse(d), solid.half);
    if (solid.shape == Shape::kCylinder) span = cylinder_span(o, d, solid.half);
    if (solid.shape == Shape::kSphere) span = sphere_span(o, d, solid.half);
    if (solid.shape == Shape::kEllipsoid) span = ellipsoid_span(o, d, solid.half);
  }
  const LaneMask self = LaneMask{} + solid.primitive;
  // Where two surfaces coincide the lower index wins, whatever the order of tests.
  const LaneMask better = (span.enter < hits.t) | ((span.enter == hits.t) & (self < hits.primitive));
  const LaneMask hit = (span.enter <= span.leave) & (span.enter > all_lanes(kMinT)) & better;
  hits.t = hit ? span.enter : hits.t;
  hits.primitive = hit ? self : hits.primitive;
}

HitPacket Bvh::nearest(const RayPacket& rays, float max_t) const {
  HitPacket hits{all_lanes(max_t), LaneMask{} - 1};
  if (nodes_.empty()) return hits;
  const Lanes3& o = rays.origin;
  const Lanes3 inverse = safe_inverse(rays.direction);
  const bool backwards[3] = {inverse.x[0] < 0, inverse.y[0] < 0, inverse.z[0] < 0};
  int32_t stack[kMaxDepth];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const int32_t index = stack[--depth];
    const Node& node = nodes_[static_cast<size_t>(index)];
    const Span x = slab(o.x, inverse.x, node.low[0], node.high[0]);
    const Span y = slab(o.y, inverse.y, node.low[1], node.high[1]);
    const Span z = slab(o.z, inverse.z, node.low[2], node.high[2]);
    const Lanes enter = max(max(x.enter, y.enter), z.enter);
    const Lanes leave = min(min(x.leave, y.leave), z.leave);
    if (!any((enter <= leave) & (leave > 0) & (enter <= hits.t))) continue;
    if (node.count > 0) {
      for (int32_t i = 0; i < node.count; ++i) {
        intersect(solids_[static_cast<size_t>(node.first) + static_cast<size_t>(i)], rays, inverse, hits);
      }
      continue;
    }
    // The nearer child is visited first (pushed last).
    const bool swap = backwards[node.axis];
    stack[depth++] = swap ? index + 1 : node.first;
    stack[depth++] = swap ? node.first : index + 1;
  }
  return hits;
}

std::vector<Candidate> Bvh::candidates(const RayBundle& bundle) const {
  const Intervals intervals(bundle);
  std::vector<Candidate> found;
  if (nodes_.empty()) return found;
  int32_t stack[kMaxDepth];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const int32_t index = stack[--depth];
    const Node& node = nodes_[static_cast<size_t>(index)];
    const float min_t = min_entry(intervals, node.low, node.high);
    if (min_t == kMissed) continue;
    if (node.count == 0) {
      stack[depth++] = index + 1;
      stack[depth++] = node.first;
      continue;
    }
    for (int32_t i = node.first; i < node.first + node.count; ++i) found.push_back({min_t, i});
  }
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    return a.min_t < b.min_t || (a.min_t == b.min_t && a.solid < b.solid);
  });
  return found;
}

HitPacket Bvh::nearest(const RayPacket& rays, float max_t, const std::vector<Candidate>& candidates) const {
  HitPacket hits{all_lanes(max_t), LaneMask{} - 1};
  const Lanes3 inverse = safe_inverse(rays.direction);
  for (const Candidate& candidate : candidates) {
    if (!any(hits.t >= candidate.min_t)) break;  // all others are farther
    intersect(solids_[static_cast<size_t>(candidate.solid)], rays, inverse, hits);
  }
  return hits;
}

}  // namespace kinloop::sim
