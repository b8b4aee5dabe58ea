#include <algorithm>

#include <fmt/format.h>

#include "kinloop/core/files/text_file.hpp"
#include "tools/export/g2o/g2o_file.hpp"
#include "tools/export/g2o/g2o_format.hpp"

namespace kinloop {
namespace {

std::string g2o_text(const SE3& T) {
  const Eigen::Vector3d& t = T.translation;
  const Eigen::Quaterniond& q = T.rotation;
  return fmt::format("{} {} {} {} {} {} {}", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

std::string g2o_text(const SE2& T) {
  return fmt::format("{} {} {}", T.translation.x(), T.translation.y(), T.angle_rad);
}

template <class Pose>
void write_graph(std::ostream& out, const BasicPoseGraph<Pose>& graph, const std::vector<int64_t>& ids) {
  using Format = G2oFormat<Pose>;
  const auto id = [&](size_t index) { return ids.empty() ? static_cast<int64_t>(index) : ids[index]; };
  const bool has_prior =
      std::any_of(graph.edges.begin(), graph.edges.end(), [](const auto& edge) { return edge.a == kWorld; });
  const bool needs_offset = has_prior && Format::kPriorIndices == 2;
  if (needs_offset) out << kG2oOffsetTag << " 0 " << g2o_text(SE3{}) << '\n';
  for (size_t vertex = 0; vertex < graph.T_world_vertex.size(); ++vertex) {
    out << fmt::format("{} {} {}\n", Format::kVertex, id(vertex), g2o_text(graph.T_world_vertex[vertex]));
  }
  for (size_t vertex = 0; vertex < graph.fixed.size(); ++vertex) {
    if (graph.fixed[vertex]) out << fmt::format("FIX {}\n", id(vertex));
  }
  for (const auto& edge : graph.edges) {
    if (edge.a == kWorld) {
      out << fmt::format("{} {}{} {}", Format::kPrior, id(edge.b), needs_offset ? " 0" : "",
                         g2o_text(edge.T_a_b));
    } else {
      out << fmt::format("{} {} {} {}", Format::kEdge, id(edge.a), id(edge.b), g2o_text(edge.T_a_b));
    }
    for (int row = 0; row < Pose::kDof; ++row) {
      for (int column = row; column < Pose::kDof; ++column) {
        out << fmt::format(" {}", edge.information(row, column));
      }
    }
    out << '\n';
  }
}

}  // namespace

void write_g2o(const std::filesystem::path& path, const G2oFile& file) {
  AtomicFile output(path);
  std::visit([&](const auto& graph) { write_graph(output.stream(), graph, file.ids); }, file.graph);
  output.commit();
}

}  // namespace kinloop
