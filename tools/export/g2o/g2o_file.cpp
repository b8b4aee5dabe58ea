#include "tools/export/g2o/g2o_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/optimize/pose_graph/pose_graph_error.hpp"
#include "tools/export/g2o/g2o_format.hpp"

namespace kinloop {
namespace {

// Relative to the largest eigenvalue; more negative ones cannot come from rounding to six digits.
constexpr double kPsdTolerance = 1e-6;

/// A line split at white space, with checked access to its numbers.
struct Line {
  const std::filesystem::path& path;
  size_t number;
  std::vector<std::string> fields;

  [[noreturn]] void fail(const std::string& what) const { throw_parse_error(path, number, what); }

  void expect_fields(size_t count) const {
    if (fields.size() == count) return;
    fail(fmt::format("{} has {} fields, expected {}{}", fields[0], fields.size(), count,
                     fields.size() < count ? "; is the line truncated?" : ""));
  }

  [[nodiscard]] int64_t id(size_t field) const {
    const std::string& text = fields[field];
    int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
      fail(fmt::format("'{}' is not a vertex id (expected an integer)", text));
    }
    return value;
  }

  [[nodiscard]] double value(size_t field) const { return parse_double(fields[field], path, number); }
};

void read_pose(const Line& line, size_t first, SE3& T) {
  for (size_t i = 0; i < 3; ++i) T.translation[static_cast<int>(i)] = line.value(first + i);
  const Eigen::Vector4d q(line.value(first + 3), line.value(first + 4), line.value(first + 5),
                          line.value(first + 6));
  if (!(q.norm() > 0) || !std::isfinite(q.norm())) line.fail("quaternion has zero or non-finite norm");
  T.rotation.coeffs() = q / q.norm();
}

void read_pose(const Line& line, size_t first, SE2& T) {
  T.translation = {line.value(first), line.value(first + 1)};
  T.angle_rad = normalized_angle(line.value(first + 2));
}

/// Reads the upper triangle, row by row.
template <class Matrix>
Matrix read_information(const Line& line, size_t field) {
  Matrix information;
  for (int row = 0; row < information.rows(); ++row) {
    for (int column = row; column < information.cols(); ++column) {
      information(row, column) = information(column, row) = line.value(field++);
    }
  }
  return information;
}

/// Replaces a matrix with negative eigenvalues by the nearest positive semi-definite one; true if it did.
template <class Matrix>
bool repair_information(Matrix& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(information);
  const auto& values = eigen.eigenvalues();
  if (values[0] >= -kPsdTolerance * values.cwiseAbs().maxCoeff()) return false;
  const auto& vectors = eigen.eigenvectors();
  const Matrix nearest = vectors * values.cwiseMax(0).asDiagonal() * vectors.transpose();
  information = 0.5 * (nearest + nearest.transpose());
  return true;
}

/// The lines read so far for one kind of pose; edges still refer to ids.
template <class Pose>
struct ParsedGraph {
  struct ParsedEdge {
    size_t line;
    int64_t id_a, id_b;  // equal for a prior
    typename BasicPoseGraph<Pose>::Edge edge;
  };
  std::vector<Pose> poses;
  std::vector<int64_t> ids;
  std::vector<ParsedEdge> edges;
  size_t first_line = 0;  // 0: none of this kind
};

struct ParserState {
  const std::filesystem::path& path;
  ParsedGraph<SE3> space;
  ParsedGraph<SE2> plane;
  std::vector<std::pair<int64_t, size_t>> fixed;  // id, line
  std::vector<int64_t> offsets;                   // ids of PARAMS_SE3OFFSET with identity value
  std::map<int64_t, size_t> vertex_lines;
  std::vector<size_t> repaired_lines;
};

template <class Pose>
void read_vertex(ParserState& state, ParsedGraph<Pose>& parsed, const Line& line) {
  line.expect_fields(2 + G2oFormat<Pose>::kNumbers);
  const int64_t id = line.id(1);
  const auto [earlier, is_new] = state.vertex_lines.emplace(id, line.number);
  if (!is_new) line.fail(fmt::format("duplicate vertex {} (first defined on line {})", id, earlier->second));
  Pose T;
  read_pose(line, 2, T);
  parsed.poses.push_back(T);
  parsed.ids.push_back(id);
}

template <class Pose>
void read_edge(ParserState& state, ParsedGraph<Pose>& parsed, const Line& line, bool is_prior) {
  using Matrix = typename BasicPoseGraph<Pose>::Matrix;
  const size_t pose_field = 1 + (is_prior ? G2oFormat<Pose>::kPriorIndices : 2);
  const size_t information_field = pose_field + G2oFormat<Pose>::kNumbers;
  line.expect_fields(information_field + Pose::kDof * (Pose::kDof + 1) / 2);
  typename ParsedGraph<Pose>::ParsedEdge read{line.number, line.id(1), line.id(is_prior ? 1 : 2), {}};
  if (!is_prior && read.id_a == read.id_b) line.fail(fmt::format("edge from vertex {} to itself", read.id_a));
  if (is_prior) read.edge.a = kWorld;
  const auto [first, second] = std::minmax(read.id_a, read.id_b);
  read.edge.is_odometry =
      !is_prior && first + 1 == second;  // `first` is below the maximum here, so no overflow
  read_pose(line, pose_field, read.edge.T_a_b);
  read.edge.information = read_information<Matrix>(line, information_field);
  if (repair_information(read.edge.information)) state.repaired_lines.push_back(line.number);
  parsed.edges.push_back(std::move(read));
}

/// Reads the line if it is of this kind of pose.
template <class Pose>
bool read_line(ParserState& state, ParsedGraph<Pose>& parsed, const Line& line) {
  const std::string& tag = line.fields[0];
  if (tag == G2oFormat<Pose>::kVertex) {
    read_vertex(state, parsed, line);
  } else if (tag == G2oFormat<Pose>::kEdge || tag == G2oFormat<Pose>::kPrior) {
    read_edge(state, parsed, line, tag == G2oFormat<Pose>::kPrior);
  } else {
    return false;
  }
  if (parsed.first_line == 0) parsed.first_line = line.number;
  return true;
}

void read_offset(ParserState& state, const Line& line) {
  line.expect_fields(2 + G2oFormat<SE3>::kNumbers);
  SE3 offset;
  read_pose(line, 2, offset);
  if (offset.translation.norm() != 0 || offset.rotation.vec().norm() != 0) {
    line.fail("only an identity offset is supported for a prior");
  }
  state.offsets.push_back(line.id(1));
}

void check_offset_of_prior(const ParserState& state, const Line& line) {
  if (std::find(state.offsets.begin(), state.offsets.end(), line.id(2)) != state.offsets.end()) return;
  line.fail(fmt::format("prior refers to {} {}, which is not defined above", kG2oOffsetTag, line.id(2)));
}

void read_line(ParserState& state, const Line& line) {
  const std::string& tag = line.fields[0];
  if (read_line(state, state.space, line)) {
    if (tag == G2oFormat<SE3>::kPrior) check_offset_of_prior(state, line);
  } else if (tag == "FIX") {
    for (size_t field = 1; field < line.fields.size(); ++field) {
      state.fixed.emplace_back(line.id(field), line.number);
    }
  } else if (tag == kG2oOffsetTag) {
    read_offset(state, line);
  } else if (!read_line(state, state.plane, line)) {
    line.fail(
        fmt::format("'{}' is not supported; expected VERTEX_SE3:QUAT and EDGE_SE3:QUAT, or "
                    "VERTEX_SE2 and EDGE_SE2, and FIX",
                    tag));
  }
}

std::vector<std::string> split(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\v\f";
  std::vector<std::string> fields;
  for (size_t begin = 0; (begin = text.find_first_not_of(kSpace, begin)) != std::string_view::npos;) {
    const size_t end = std::min(text.find_first_of(kSpace, begin), text.size());
    fields.emplace_back(text.substr(begin, end - begin));
    begin = end;
  }
  return fields;
}

/// Without vertices in the file, creates those referenced by edges, in order of their ids.
template <class Pose>
std::vector<int64_t> ids_of_edges(const ParsedGraph<Pose>& parsed) {
  std::vector<int64_t> ids;
  for (const auto& read : parsed.edges) ids.insert(ids.end(), {read.id_a, read.id_b});
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

/// Converts ids to indices.
template <class Pose>
G2oFile finish(const ParserState& state, const ParsedGraph<Pose>& parsed) {
  G2oFile file;
  file.had_vertices = !parsed.ids.empty();
  file.ids = file.had_vertices ? parsed.ids : ids_of_edges(parsed);
  file.repaired_lines = state.repaired_lines;
  std::map<int64_t, uint32_t> index_of;
  for (uint32_t index = 0; index < file.ids.size(); ++index) index_of[file.ids[index]] = index;
  const auto find = [&](int64_t id, size_t line) {
    const auto found = index_of.find(id);
    if (found == index_of.end()) throw_parse_error(state.path, line, fmt::format("undefined vertex {}", id));
    return found->second;
  };

  BasicPoseGraph<Pose> graph;
  graph.T_world_vertex = parsed.poses;
  graph.T_world_vertex.resize(file.ids.size());
  if (!state.fixed.empty()) graph.fixed.resize(file.ids.size());
  for (const auto& [id, line] : state.fixed) graph.fixed[find(id, line)] = true;
  for (const auto& read : parsed.edges) {
    graph.edges.push_back(read.edge);
    graph.edges.back().b = find(read.id_b, read.line);
    if (read.edge.a != kWorld) graph.edges.back().a = find(read.id_a, read.line);
  }
  if (!file.had_vertices) graph.T_world_vertex = spanning_tree_poses(graph);
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    if (std::isfinite(edge_chi2(graph.T_world_vertex, graph.edges[i]))) continue;
    throw_parse_error(state.path, parsed.edges[i].line, "edge values are too large: its chi2 is not finite");
  }
  file.graph = std::move(graph);
  return file;
}

}  // namespace

G2oFile read_g2o(const std::filesystem::path& path) {
  const std::string content = read_file(path);
  ParserState state{path, {}, {}, {}, {}, {}, {}};
  size_t number = 0;
  for (size_t begin = 0; begin < content.size();) {
    const size_t end = std::min(content.find('\n', begin), content.size());
    const std::string_view text = std::string_view(content).substr(begin, end - begin);
    if (text.find('\0') != text.npos)
      throw_parse_error(path, number + 1, "not a text file; is it a .g2o file?");
    const Line line{path, ++number, split(text)};
    if (!line.fields.empty() && line.fields[0][0] != '#') read_line(state, line);
    begin = end + 1;
  }
  const size_t space = state.space.first_line, plane = state.plane.first_line;
  if (space == 0 && plane == 0)
    throw InputError(path.string() + ": no vertices and no edges; is it a .g2o file?");
  if (space != 0 && plane != 0) {
    throw_parse_error(path, std::max(space, plane), "SE(2) and SE(3) elements in the same file");
  }
  return space != 0 ? finish(state, state.space) : finish(state, state.plane);
}

}  // namespace kinloop
