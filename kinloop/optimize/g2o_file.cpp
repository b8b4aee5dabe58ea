#include "kinloop/optimize/g2o_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/text_file.hpp"
#include "kinloop/optimize/g2o_format.hpp"
#include "kinloop/optimize/pose_graph_error.hpp"

namespace kinloop {
namespace {

// An eigenvalue this far below zero, relative to the largest, is no rounding of six printed digits.
constexpr double kPsdTolerance = 1e-6;

/// One line, split at white space, with checked access to its numbers.
struct Line {
  const std::filesystem::path& path;
  size_t number;
  std::vector<std::string> fields;

  [[noreturn]] void fail(const std::string& what) const { throw_at(path, number, what); }

  void expect_fields(size_t count) const {
    if (fields.size() == count) return;
    fail(fmt::format("{} with {} fields, expected {}{}", fields[0], fields.size(), count,
                     fields.size() < count ? "; is the line cut short?" : ""));
  }

  [[nodiscard]] int64_t id(size_t field) const {
    const std::string& text = fields[field];
    int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
      fail(fmt::format("'{}' is not a vertex id (a whole number)", text));
    }
    return value;
  }

  [[nodiscard]] double value(size_t field) const { return parse_double(fields[field], path, number); }
};

void read_pose(const Line& line, size_t first, SE3& T) {
  for (size_t i = 0; i < 3; ++i) T.translation[static_cast<int>(i)] = line.value(first + i);
  const Eigen::Vector4d q(line.value(first + 3), line.value(first + 4), line.value(first + 5),
                          line.value(first + 6));
  if (!(q.norm() > 0) || !std::isfinite(q.norm())) line.fail("the quaternion has no direction");
  T.rotation.coeffs() = q / q.norm();
}

void read_pose(const Line& line, size_t first, SE2& T) {
  T.translation = {line.value(first), line.value(first + 1)};
  T.angle_rad = normalized_angle(line.value(first + 2));
}

/// The upper triangle, row by row.
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

/// Replaces a matrix with negative eigenvalues by the nearest without; whether it had to.
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

/// What the lines of one kind of pose have given so far; edges still name ids.
template <class Pose>
struct Draft {
  struct DraftEdge {
    size_t line;
    int64_t id_a, id_b;  // equal for a prior
    typename BasicPoseGraph<Pose>::Edge edge;
  };
  std::vector<Pose> poses;
  std::vector<int64_t> ids;
  std::vector<DraftEdge> edges;
  size_t first_line = 0;  // 0: the file has none of this kind
};

struct Reading {
  const std::filesystem::path& path;
  Draft<SE3> space;
  Draft<SE2> plane;
  std::vector<std::pair<int64_t, size_t>> fixed;  // id, line
  std::vector<int64_t> offsets;                   // ids of identity PARAMS_SE3OFFSET
  std::map<int64_t, size_t> vertex_lines;
  std::vector<size_t> repaired_lines;
};

template <class Pose>
void read_vertex(Reading& reading, Draft<Pose>& draft, const Line& line) {
  line.expect_fields(2 + G2oFormat<Pose>::kNumbers);
  const int64_t id = line.id(1);
  const auto [earlier, is_new] = reading.vertex_lines.emplace(id, line.number);
  if (!is_new) line.fail(fmt::format("vertex {} is given again (first in line {})", id, earlier->second));
  Pose T;
  read_pose(line, 2, T);
  draft.poses.push_back(T);
  draft.ids.push_back(id);
}

template <class Pose>
void read_edge(Reading& reading, Draft<Pose>& draft, const Line& line, bool is_prior) {
  using Matrix = typename BasicPoseGraph<Pose>::Matrix;
  const size_t pose_field = 1 + (is_prior ? G2oFormat<Pose>::kPriorIndices : 2);
  const size_t information_field = pose_field + G2oFormat<Pose>::kNumbers;
  line.expect_fields(information_field + Pose::kDof * (Pose::kDof + 1) / 2);
  typename Draft<Pose>::DraftEdge read{line.number, line.id(1), line.id(is_prior ? 1 : 2), {}};
  if (!is_prior && read.id_a == read.id_b)
    line.fail(fmt::format("an edge from vertex {} to itself", read.id_a));
  if (is_prior) read.edge.a = kWorld;
  const auto [first, second] = std::minmax(read.id_a, read.id_b);
  read.edge.trusted = !is_prior && first + 1 == second;  // first is not the largest number there is
  read_pose(line, pose_field, read.edge.T_a_b);
  read.edge.information = read_information<Matrix>(line, information_field);
  if (repair_information(read.edge.information)) reading.repaired_lines.push_back(line.number);
  draft.edges.push_back(std::move(read));
}

/// Reads the line if it is of this kind of pose.
template <class Pose>
bool read_line(Reading& reading, Draft<Pose>& draft, const Line& line) {
  const std::string& tag = line.fields[0];
  if (tag == G2oFormat<Pose>::kVertex) {
    read_vertex(reading, draft, line);
  } else if (tag == G2oFormat<Pose>::kEdge || tag == G2oFormat<Pose>::kPrior) {
    read_edge(reading, draft, line, tag == G2oFormat<Pose>::kPrior);
  } else {
    return false;
  }
  if (draft.first_line == 0) draft.first_line = line.number;
  return true;
}

void read_offset(Reading& reading, const Line& line) {
  line.expect_fields(2 + G2oFormat<SE3>::kNumbers);
  SE3 offset;
  read_pose(line, 2, offset);
  if (offset.translation.norm() != 0 || offset.rotation.vec().norm() != 0) {
    line.fail("only the identity is supported as offset of a prior");
  }
  reading.offsets.push_back(line.id(1));
}

void check_offset_of_prior(const Reading& reading, const Line& line) {
  if (std::find(reading.offsets.begin(), reading.offsets.end(), line.id(2)) != reading.offsets.end()) return;
  line.fail(fmt::format("the prior refers to {} {}, which is not given above", kG2oOffsetTag, line.id(2)));
}

void read_line(Reading& reading, const Line& line) {
  const std::string& tag = line.fields[0];
  if (read_line(reading, reading.space, line)) {
    if (tag == G2oFormat<SE3>::kPrior) check_offset_of_prior(reading, line);
  } else if (tag == "FIX") {
    for (size_t field = 1; field < line.fields.size(); ++field) {
      reading.fixed.emplace_back(line.id(field), line.number);
    }
  } else if (tag == kG2oOffsetTag) {
    read_offset(reading, line);
  } else if (!read_line(reading, reading.plane, line)) {
    line.fail(
        fmt::format("'{}' is not supported; a pose graph has VERTEX_SE3:QUAT and EDGE_SE3:QUAT, or "
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

/// Without vertices in the file, those that the edges name, in the order of their ids.
template <class Pose>
std::vector<int64_t> ids_of_edges(const Draft<Pose>& draft) {
  std::vector<int64_t> ids;
  for (const auto& read : draft.edges) ids.insert(ids.end(), {read.id_a, read.id_b});
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

/// Turns ids into indices.
template <class Pose>
G2oFile finish(const Reading& reading, const Draft<Pose>& draft) {
  G2oFile file;
  file.had_vertices = !draft.ids.empty();
  file.ids = file.had_vertices ? draft.ids : ids_of_edges(draft);
  file.repaired_lines = reading.repaired_lines;
  std::map<int64_t, uint32_t> index_of;
  for (uint32_t index = 0; index < file.ids.size(); ++index) index_of[file.ids[index]] = index;
  const auto find = [&](int64_t id, size_t line) {
    const auto found = index_of.find(id);
    if (found == index_of.end()) throw_at(reading.path, line, fmt::format("there is no vertex {}", id));
    return found->second;
  };

  BasicPoseGraph<Pose> graph;
  graph.T_world_vertex = draft.poses;
  graph.T_world_vertex.resize(file.ids.size());
  if (!reading.fixed.empty()) graph.fixed.resize(file.ids.size());
  for (const auto& [id, line] : reading.fixed) graph.fixed[find(id, line)] = true;
  for (const auto& read : draft.edges) {
    graph.edges.push_back(read.edge);
    graph.edges.back().b = find(read.id_b, read.line);
    if (read.edge.a != kWorld) graph.edges.back().a = find(read.id_a, read.line);
  }
  if (!file.had_vertices) graph.T_world_vertex = spanning_tree_poses(graph);
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    if (std::isfinite(edge_chi2(graph.T_world_vertex, graph.edges[i]))) continue;
    throw_at(reading.path, draft.edges[i].line, "the numbers of this edge are too large to reckon with");
  }
  file.graph = std::move(graph);
  return file;
}

}  // namespace

G2oFile read_g2o(const std::filesystem::path& path) {
  const std::string content = read_file(path);
  Reading reading{path, {}, {}, {}, {}, {}, {}};
  size_t number = 0;
  for (size_t begin = 0; begin < content.size();) {
    const size_t end = std::min(content.find('\n', begin), content.size());
    const std::string_view text = std::string_view(content).substr(begin, end - begin);
    if (text.find('\0') != text.npos) throw_at(path, number + 1, "this is no text; is it a .g2o file?");
    const Line line{path, ++number, split(text)};
    if (!line.fields.empty() && line.fields[0][0] != '#') read_line(reading, line);
    begin = end + 1;
  }
  const size_t space = reading.space.first_line, plane = reading.plane.first_line;
  if (space == 0 && plane == 0)
    throw InputError(path.string() + ": no vertices and no edges; is it a .g2o file?");
  if (space != 0 && plane != 0) {
    throw_at(path, std::max(space, plane), "poses in space and in the plane in one file");
  }
  return space != 0 ? finish(reading, reading.space) : finish(reading, reading.plane);
}

}  // namespace kinloop
