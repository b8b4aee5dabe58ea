#include "dense/texture/choose_views.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include <Eigen/Geometry>

namespace kinloop {
namespace {

/// Resolution is given up, at most by this much, before a seam of the same length is made: a factor of e over
/// a strip as wide as this, metres.
constexpr float kSeamCostM = 0.03F;

/// What a pair costs whose triangles have different views, and where its messages are: `forward` has a number
/// for each label of the second triangle, `backward` for each of the first.
struct Link {
  uint32_t first = 0, second = 0;
  float seam_cost = 0;
  size_t forward = 0, backward = 0;
};

/// Minimises the sum of the costs of labels and of links between different labels.
class MessagePassing {
 public:
  MessagePassing(const ColoredMesh& mesh, const ViewCandidates& candidates) {
    add_labels(mesh, candidates);
    add_links(adjacent_triangles(mesh));
  }

  std::vector<uint32_t> run() {
    constexpr int kRounds = 12;
    for (int round = 0; round < kRounds; ++round) {
      for (uint32_t i = 0; i < triangles(); ++i) send_from(i, true);
      for (uint32_t i = triangles(); i-- > 0;) send_from(i, false);
    }
    return decode();
  }

 private:
  [[nodiscard]] uint32_t triangles() const { return static_cast<uint32_t>(first_label_.size() - 1); }
  [[nodiscard]] size_t labels(uint32_t triangle) const {
    return first_label_[triangle + 1] - first_label_[triangle];
  }
  [[nodiscard]] std::span<const uint32_t> views(uint32_t triangle) const {
    return std::span(views_).subspan(first_label_[triangle], labels(triangle));
  }
  [[nodiscard]] std::span<const Link* const> links(uint32_t triangle) const {
    return std::span(links_of_).subspan(first_link_[triangle],
                                        first_link_[triangle + 1] - first_link_[triangle]);
  }

  void add_labels(const ColoredMesh& mesh, const ViewCandidates& candidates) {
    first_label_ = {0};
    for (size_t i = 0; i < candidates.size(); ++i) {
      const auto& [a, b, c] = mesh.triangles[i];
      const float area_m2 =
          (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).norm() / 2;
      float best = 0;
      for (const ViewCandidate& each : candidates[i]) best = std::max(best, each.quality);
      for (const ViewCandidate& each : candidates[i]) {
        views_.push_back(each.view);
        costs_.push_back(area_m2 * std::log(best / each.quality));
      }
      first_label_.push_back(views_.size());
    }
  }

  void add_links(const std::vector<TrianglePair>& pairs) {
    size_t messages = 0;
    links_.reserve(pairs.size());
    first_link_.assign(first_label_.size(), 0);
    for (const TrianglePair& pair : pairs) {
      if (labels(pair.first) == 0 || labels(pair.second) == 0) continue;
      Link link{pair.first, pair.second, kSeamCostM * pair.edge_m, messages, 0};
      link.backward = messages + labels(pair.second);
      messages = link.backward + labels(pair.first);
      links_.push_back(link);
      ++first_link_[pair.first + 1], ++first_link_[pair.second + 1];
    }
    for (size_t i = 1; i < first_link_.size(); ++i) first_link_[i] += first_link_[i - 1];
    links_of_.resize(2 * links_.size());
    std::vector<size_t> next(first_link_.begin(), first_link_.end() - 1);
    for (const Link& link : links_) links_of_[next[link.first]++] = links_of_[next[link.second]++] = &link;
    messages_.assign(messages, 0);
  }

  /// The messages of a link to one of its triangles.
  float* message_to(const Link& link, uint32_t triangle) {
    return &messages_[triangle == link.first ? link.backward : link.forward];
  }

  /// Costs of the labels of a triangle and of all messages to it.
  void sum_messages(uint32_t triangle) {
    const auto begin = costs_.begin() + static_cast<std::ptrdiff_t>(first_label_[triangle]);
    sums_.assign(begin, begin + static_cast<std::ptrdiff_t>(labels(triangle)));
    for (const Link* link : links(triangle)) {
      const float* message = message_to(*link, triangle);
      for (size_t x = 0; x < sums_.size(); ++x) sums_[x] += message[x];
    }
  }

  /// Sends messages to the triangles that come later, or to the earlier ones.
  void send_from(uint32_t triangle, bool to_later) {
    if (links(triangle).empty()) return;
    sum_messages(triangle);
    const auto all = links(triangle);
    const auto later = static_cast<size_t>(
        std::count_if(all.begin(), all.end(), [&](const Link* link) { return link->first == triangle; }));
    const float share = 1 / static_cast<float>(std::max(later, all.size() - later));
    for (const Link* link : all) {
      if ((link->first == triangle) == to_later) send(*link, triangle, share);
    }
  }

  void send(const Link& link, uint32_t from, float share) {
    const uint32_t to = from == link.first ? link.second : link.first;
    const float* received = message_to(link, from);
    float* sent = message_to(link, to);
    const auto from_views = views(from), to_views = views(to);
    const auto cost = [&](size_t x) { return share * sums_[x] - received[x]; };
    float lowest = cost(0);
    for (size_t x = 1; x < from_views.size(); ++x) lowest = std::min(lowest, cost(x));
    float lowest_sent = lowest + link.seam_cost;
    for (size_t x = 0, y = 0; y < to_views.size(); ++y) {
      while (x < from_views.size() && from_views[x] < to_views[y]) ++x;
      const bool common = x < from_views.size() && from_views[x] == to_views[y];
      sent[y] = std::min(lowest + link.seam_cost, common ? cost(x) : lowest + link.seam_cost);
      lowest_sent = std::min(lowest_sent, sent[y]);
    }
    for (size_t y = 0; y < to_views.size(); ++y) sent[y] -= lowest_sent;
  }

  /// The best label of each triangle, given those of the earlier ones and the messages of the later ones.
  std::vector<uint32_t> decode() {
    std::vector<uint32_t> chosen(triangles(), kNoView);
    for (uint32_t i = 0; i < triangles(); ++i) {
      if (labels(i) == 0) continue;
      sum_messages(i);
      for (const Link* link : links(i)) {
        if (link->second != i) continue;
        const float* message = message_to(*link, i);
        for (size_t x = 0; x < sums_.size(); ++x)
          sums_[x] += (views(i)[x] == chosen[link->first] ? 0 : link->seam_cost) - message[x];
      }
      chosen[i] = views(i)[static_cast<size_t>(std::min_element(sums_.begin(), sums_.end()) - sums_.begin())];
    }
    return chosen;
  }

  std::vector<size_t> first_label_;  // per triangle, and the end
  std::vector<uint32_t> views_;      // per label
  std::vector<float> costs_;         // per label
  std::vector<Link> links_;
  std::vector<size_t> first_link_;  // per triangle, and the end
  std::vector<const Link*> links_of_;
  std::vector<float> messages_;
  std::vector<float> sums_;  // of one triangle
};

}  // namespace

std::vector<TrianglePair> adjacent_triangles(const ColoredMesh& mesh) {
  struct Side {
    uint32_t low, high, triangle;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      sides.push_back({std::min(from, to), std::max(from, to), i});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  std::vector<TrianglePair> pairs;
  for (size_t i = 1; i < sides.size(); ++i) {
    const Side &a = sides[i - 1], &b = sides[i];
    if (a.low != b.low || a.high != b.high || a.triangle == b.triangle) continue;
    pairs.push_back({a.triangle, b.triangle, (mesh.points[a.low] - mesh.points[a.high]).norm()});
  }
  std::sort(pairs.begin(), pairs.end(), [](const TrianglePair& a, const TrianglePair& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  });
  return pairs;
}

std::vector<uint32_t> choose_views(const ColoredMesh& mesh, const ViewCandidates& candidates) {
  return MessagePassing(mesh, candidates).run();
}

}  // namespace kinloop
