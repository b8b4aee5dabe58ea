#include "python/bindings/pose_graph.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "kinloop/core/errors.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/gil.hpp"
#include "python/bindings/options.hpp"

namespace kinloop::python {
namespace {

/// How a solver ended.
struct PoseGraphSummary {
  double chi2_before = 0, chi2_after = 0;
  int iterations = 0;
  double seconds = 0;
  bool converged = false;
  std::string solver;
};

Eigen::Matrix4d matrix_of(const SE3& T) {
  return T.matrix();
}

Eigen::Matrix3d matrix_of(const SE2& T) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix.topLeftCorner<2, 2>() = T.R();
  matrix.topRightCorner<2, 1>() = T.translation;
  return matrix;
}

py::array poses_of(const PyPoseGraph& graph) {
  return std::visit(
      [](const auto& g) -> py::array {
        constexpr int kSize = decltype(matrix_of(g.T_world_vertex[0]))::RowsAtCompileTime;
        py::array_t<double> array(
            {static_cast<py::ssize_t>(g.T_world_vertex.size()), py::ssize_t{kSize}, py::ssize_t{kSize}});
        double* at = array.mutable_data();
        for (const auto& T : g.T_world_vertex) {
          Eigen::Map<Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>> to(at);
          to = matrix_of(T);
          at += kSize * kSize;
        }
        return array;
      },
      graph.file.graph);
}

py::array_t<uint32_t> edges_of(const PyPoseGraph& graph) {
  return std::visit(
      [](const auto& g) {
        py::array_t<uint32_t> array({static_cast<py::ssize_t>(g.edges.size()), py::ssize_t{2}});
        uint32_t* at = array.mutable_data();
        for (const auto& edge : g.edges) {
          *at++ = edge.a;
          *at++ = edge.b;
        }
        return array;
      },
      graph.file.graph);
}

PoseGraph& graph_3d(PyPoseGraph& graph) {
  auto* g = std::get_if<PoseGraph>(&graph.file.graph);
  if (g == nullptr)
    throw UsageError("PoseGraph: a graph in 2D cannot be extended; only optimise and save it");
  graph.file.ids.clear();  // as indices
  return *g;
}

size_t add_vertex(PyPoseGraph& graph, const Eigen::Matrix4d& T_world_vertex, bool fixed) {
  PoseGraph& g = graph_3d(graph);
  g.T_world_vertex.push_back(to_se3(T_world_vertex, "T_world_vertex"));
  if (fixed || !g.fixed.empty()) g.fixed.resize(g.T_world_vertex.size(), false);
  if (fixed) g.fixed.back() = true;
  return g.T_world_vertex.size() - 1;
}

void add_edge(PyPoseGraph& graph, uint32_t a, uint32_t b, const Eigen::Matrix4d& T_a_b,
              const std::optional<Matrix6d>& information) {
  PoseGraph& g = graph_3d(graph);
  if (a >= g.T_world_vertex.size() || b >= g.T_world_vertex.size() || a == b)
    throw UsageError(
        fmt::format("add_edge({}, {}): the graph has {} vertices", a, b, g.T_world_vertex.size()));
  const Matrix6d weight = information.value_or(Matrix6d::Identity());
  if (!weight.allFinite() || !weight.isApprox(weight.transpose(), 1e-9))
    throw UsageError("information: expected a symmetric 6x6 matrix");
  g.edges.push_back({a, b, to_se3(T_a_b, "T_a_b"), weight, b == a + 1});
}

PoseGraphSummary optimize(PyPoseGraph& graph, const py::kwargs& options) {
  const auto settings = with_assignments(PoseGraphOptions{}, assignments_of(options));
  return std::visit(
      [&](auto& g) {
        const auto copy = g;  // other threads may read and extend the graph meanwhile
        const auto solution = without_gil([&] { return solve_pose_graph(copy, settings); });
        std::copy(solution.T_world_vertex.begin(), solution.T_world_vertex.end(), g.T_world_vertex.begin());
        return PoseGraphSummary{solution.chi2_before, solution.chi2_after,
                                solution.iterations,  solution.seconds,
                                solution.converged,   std::string(name_of(solution.solver))};
      },
      graph.file.graph);
}

size_t vertex_count(const PyPoseGraph& graph) {
  return std::visit([](const auto& g) { return g.T_world_vertex.size(); }, graph.file.graph);
}

void bind_summary(py::module_& module) {
  using Summary = PoseGraphSummary;
  py::class_<Summary>(module, "PoseGraphSummary",
                      "How an optimisation ended; chi2 is without the robust kernel.")
      .def_readonly("chi2_before", &Summary::chi2_before)
      .def_readonly("chi2_after", &Summary::chi2_after)
      .def_readonly("iterations", &Summary::iterations)
      .def_readonly("seconds", &Summary::seconds, "Time of the solver.")
      .def_readonly("converged", &Summary::converged)
      .def_readonly("solver", &Summary::solver)
      .def("__repr__", [](const Summary& s) {
        return fmt::format("<kinloop.PoseGraphSummary: chi2 {:.6g} -> {:.6g}, {} iterations by {}{}>",
                           s.chi2_before, s.chi2_after, s.iterations, s.solver,
                           s.converged ? "" : ", not converged");
      });
}

}  // namespace

void bind_pose_graph(py::module_& module) {
  bind_summary(module);
  py::class_<PyPoseGraph>(module, "PoseGraph", R"(Poses and measured relative poses between them.

The error of an edge is that of g2o's EDGE_SE3:QUAT and EDGE_SE2, so chi2 agrees with other programs.)")
      .def(py::init([] {
             return PyPoseGraph{{PoseGraph{}, {}, true, {}}};
           }),
           "An empty graph in 3D.")
      .def_static(
          "load", [](const std::filesystem::path& path) { return PyPoseGraph{read_g2o(path)}; },
          py::arg("path"), "Reads a .g2o file, 3D or 2D. Raises InputError naming file and line.")
      .def(
          "save", [](const PyPoseGraph& g, const std::filesystem::path& path) { write_g2o(path, g.file); },
          py::arg("path"), "Writes a .g2o file, with enough digits to read back identical numbers.")
      .def("add_vertex", &add_vertex, py::arg("T_world_vertex"), py::arg("fixed") = false,
           "Adds a pose, (4, 4), and returns its index. Without a fixed vertex the first one is fixed.")
      .def("add_edge", &add_edge, py::arg("a"), py::arg("b"), py::arg("T_a_b"),
           py::arg("information") = py::none(),
           "Adds a measurement T_a_b, (4, 4), with an information matrix (6, 6) of (translation; rotation). "
           "Edges to the "
           "next vertex count as odometry: a robust kernel does not apply to them.")
      .def("optimize", &optimize, R"(Finds the poses with the least squared error; the graph then has them.

Keywords are those of kinloop optimize: solver ("builtin", "ceres"), robust_kernel ("huber", "cauchy", "geman-mcclure",
"dcs"), robust_width, max_iterations, method, start. Returns a PoseGraphSummary. Raises UsageError for a bad option.)")
      .def(
          "chi2",
          [](const PyPoseGraph& g) {
            return std::visit([](const auto& x) { return chi2(x); }, g.file.graph);
          },
          "Returns the sum of e' Omega e over all edges.")
      .def_property_readonly("poses", &poses_of,
                             "T_world_vertex, float64 (N, 4, 4); in 2D (N, 3, 3). A copy.")
      .def_property_readonly("edges", &edges_of,
                             "Indices of the vertices of each edge, uint32 (M, 2); 2**32 - 1: the world.")
      .def("__len__", &vertex_count)
      .def("__repr__", [](const PyPoseGraph& g) {
        return fmt::format("<kinloop.PoseGraph: {} vertices, {} edges>", vertex_count(g),
                           edges_of(g).shape(0));
      });
}

}  // namespace kinloop::python
