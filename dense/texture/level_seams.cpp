#include "dense/texture/level_seams.hpp"

#include <algorithm>

#include <Eigen/Sparse>

#include "dense/texture/choose_views.hpp"

namespace kinloop {
namespace {

/// A vertex in a view.
struct Node {
  uint32_t view = 0;
  Eigen::Vector3d color_sum = Eigen::Vector3d::Zero();
  double triangles = 0;

  [[nodiscard]] Eigen::Vector3d color() const { return color_sum / std::max(triangles, 1.0); }
};

/// The nodes of each vertex, in order of their views.
class SeamGraph {
 public:
  SeamGraph(const ColoredMesh& mesh, std::span<const uint32_t> view_of_triangle,
            const ViewCandidates& candidates)
      : mesh_(mesh), view_of_triangle_(view_of_triangle), nodes_(mesh.points.size()) {
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      if (view_of_triangle[i] == kNoView) continue;
      for (const uint32_t vertex : mesh.triangles[i]) add_node(vertex, view_of_triangle[i]);
    }
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (const uint32_t vertex : mesh.triangles[i]) add_colors(vertex, candidates[i]);
    }
    first_ = {0};
    for (const auto& nodes : nodes_) first_.push_back(first_.back() + static_cast<int>(nodes.size()));
  }

  /// Offsets per node, one column for each channel.
  [[nodiscard]] Eigen::MatrixX3d solve() const {
    constexpr double kSmoothness = 0.1, kPrior = 1e-3;  // relative to seams
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(first_.back(), 3);
    const auto add = [&](int i, int k, double weight) {
      entries.emplace_back(i, i, weight), entries.emplace_back(k, k, weight);
      entries.emplace_back(i, k, -weight), entries.emplace_back(k, i, -weight);
    };
    for (int i = 0; i < first_.back(); ++i) entries.emplace_back(i, i, kPrior);
    for (size_t vertex = 0; vertex < nodes_.size(); ++vertex) {
      const auto& nodes = nodes_[vertex];
      for (size_t a = 0; a < nodes.size(); ++a) {
        for (size_t b = a + 1; b < nodes.size(); ++b) {
          if (nodes[a].triangles == 0 || nodes[b].triangles == 0) continue;
          const int i = first_[vertex] + static_cast<int>(a), k = first_[vertex] + static_cast<int>(b);
          const Eigen::RowVector3d difference = (nodes[b].color() - nodes[a].color()).transpose();
          add(i, k, 1);
          right.row(i) += difference, right.row(k) -= difference;
        }
      }
    }
    for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (view_of_triangle_[t] == kNoView) continue;
      const auto& [a, b, c] = mesh_.triangles[t];
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
        add(index(from, view_of_triangle_[t]), index(to, view_of_triangle_[t]), kSmoothness);
    }
    Eigen::SparseMatrix<double> H(first_.back(), first_.back());
    H.setFromTriplets(entries.begin(), entries.end());
    return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(H).solve(right);
  }

  [[nodiscard]] VertexViews with_offsets(const Eigen::MatrixX3d& offsets) const {
    VertexViews result(nodes_.size());
    for (size_t vertex = 0; vertex < nodes_.size(); ++vertex) {
      for (size_t k = 0; k < nodes_[vertex].size(); ++k) {
        const Eigen::RowVector3d offset = offsets.row(first_[vertex] + static_cast<int>(k));
        result[vertex].push_back({nodes_[vertex][k].view, offset.transpose().cast<float>()});
      }
    }
    return result;
  }

  [[nodiscard]] int size() const { return first_.back(); }

 private:
  static bool precedes(const Node& node, uint32_t view) { return node.view < view; }

  void add_node(uint32_t vertex, uint32_t view) {
    auto& nodes = nodes_[vertex];
    const auto at = std::lower_bound(nodes.begin(), nodes.end(), view, precedes);
    if (at == nodes.end() || at->view != view) nodes.insert(at, Node{view});
  }

  void add_colors(uint32_t vertex, const std::vector<ViewCandidate>& candidates) {
    for (Node& node : nodes_[vertex]) {
      const auto found =
          std::lower_bound(candidates.begin(), candidates.end(), node.view,
                           [](const ViewCandidate& c, uint32_t view) { return c.view < view; });
      if (found == candidates.end() || found->view != node.view) continue;
      node.color_sum += found->color_bgr.cast<double>();
      node.triangles += 1;
    }
  }

  [[nodiscard]] int index(uint32_t vertex, uint32_t view) const {
    const auto& nodes = nodes_[vertex];
    const auto at = std::lower_bound(nodes.begin(), nodes.end(), view, precedes);
    return first_[vertex] + static_cast<int>(at - nodes.begin());
  }

  const ColoredMesh& mesh_;
  std::span<const uint32_t> view_of_triangle_;
  std::vector<std::vector<Node>> nodes_;
  std::vector<int> first_;  // index of the first node of each vertex, and the end
};

}  // namespace

VertexViews level_seams(const ColoredMesh& mesh, std::span<const uint32_t> view_of_triangle,
                        const ViewCandidates& candidates) {
  const SeamGraph graph(mesh, view_of_triangle, candidates);
  return graph.with_offsets(graph.size() > 0 ? graph.solve() : Eigen::MatrixX3d(0, 3));
}

}  // namespace kinloop
