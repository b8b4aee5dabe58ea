// kinloop optimize: optimises a pose graph in a .g2o file.

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/text/json.hpp"
#include "session/store/command_files.hpp"
#include "tools/export/g2o/g2o_file.hpp"
#include "viewer/report/graph_report.hpp"

namespace kinloop {
namespace {

constexpr const char* kOptimizeFooter = R"(
chi2 is the sum over all edges of e' Omega e, with the error e as in g2o's EDGE_SE3:QUAT and EDGE_SE2; it is
always given without the robust kernel, so that runs can be compared. 'seconds' is the time of the solver only.
A file without vertices starts from poses chained along a spanning tree; without a FIX line the first vertex of
each connected part is fixed. Edges between successive ids are treated as odometry: the robust kernel does not apply to them.

Examples:
  kinloop optimize sphere2500.g2o -o solved.g2o --report solved.html          with pictures before and after
  kinloop optimize out/graph.g2o -o out/robust.g2o --robust geman-mcclure      some loop edges may be false
  kinloop optimize graph.g2o -o solved.g2o --solver ceres --json               compare the solvers)";

struct OptimizeArguments {
  std::filesystem::path input;
  std::filesystem::path output;
  std::filesystem::path report;
  std::string solver, method, start, robust, robust_width, iterations;
  bool overwrite = false;
  bool json = false;
};

PoseGraphOptions pose_graph_options(const OptimizeArguments& arguments) {
  std::vector<std::string> assignments;
  const auto add = [&](const char* key, const std::string& value) {
    if (!value.empty()) assignments.push_back(fmt::format("{}={}", key, value));
  };
  add("solver", arguments.solver);
  add("method", arguments.method);
  add("start", arguments.start);
  add("robust_kernel", arguments.robust);
  add("robust_width", arguments.robust_width);
  add("max_iterations", arguments.iterations);
  return with_assignments(PoseGraphOptions{}, assignments);
}

/// Throws before any work is done if a result could not be written, or would replace the input.
void check_outputs(const OptimizeArguments& arguments) {
  CommandFiles files{.inputs = {arguments.input}, .outputs = {{"--report", arguments.report}}};
  std::error_code absent;
  if (arguments.overwrite && std::filesystem::equivalent(arguments.input, arguments.output, absent)) {
    require_writable_file(arguments.output);  // the graph is read before it is replaced
  } else {
    files.outputs.push_back(
        {"-o", arguments.output, "give another name, or --overwrite to replace the input"});
  }
  require_outputs(files);
}

/// Warns of problems of the file that affect the result.
void warn_about(const G2oFile& file, size_t parts, const std::filesystem::path& path) {
  if (!file.repaired_lines.empty()) {
    log::warn(
        "{}:{}: the information matrices of {} edges, this one first, are not positive semi-definite; "
        "replaced by the nearest that are",
        path.string(), file.repaired_lines.front(), file.repaired_lines.size());
  }
  if (!file.had_vertices) log::info("{}: no vertices, starting from a spanning tree", path.string());
  if (parts > 1)
    log::warn("{}: the graph has {} disconnected parts; each is solved separately", path.string(), parts);
}

template <class Pose>
std::vector<Eigen::Vector3d> positions(const std::vector<Pose>& T_world_vertex) {
  std::vector<Eigen::Vector3d> points;
  for (const Pose& T : T_world_vertex) {
    points.emplace_back(Eigen::Vector3d::Zero());
    points.back().head(T.translation.size()) = T.translation;
  }
  return points;
}

/// The page with the graph before and after.
template <class Pose>
std::string page(const std::string& title, const std::vector<Pose>& before, const BasicPoseGraph<Pose>& graph,
                 const BasicPoseGraphSolution<Pose>& solution) {
  GraphReport report;
  report.title = title;
  report.subtitle = fmt::format("{} vertices, {} edges", graph.T_world_vertex.size(), graph.edges.size());
  report.tiles = {
      {fmt::format("{:.4g}", solution.chi2_before), "chi2 before"},
      {fmt::format("{:.4g}", solution.chi2_after), "chi2 after"},
      {std::to_string(solution.iterations), fmt::format("iterations by {}", name_of(solution.solver))},
      {fmt::format("{:.3f} s", solution.seconds), "solving"}};
  report.before = positions(before);
  report.after = positions(solution.T_world_vertex);
  for (const auto& edge : graph.edges) {
    if (edge.a == kWorld) continue;
    (edge.is_odometry ? report.steps : report.loops).emplace_back(edge.a, edge.b);
  }
  return render_graph_report(report);
}

template <class Pose>
void print(const BasicPoseGraph<Pose>& graph, const BasicPoseGraphSolution<Pose>& solution, size_t parts,
           const G2oFile& file, const OptimizeArguments& arguments) {
  std::FILE* to = message_stream(arguments.output);
  if (arguments.json) {
    const nlohmann::ordered_json figures = {
        {"chi2_before", solution.chi2_before},
        {"chi2_after", solution.chi2_after},
        {"iterations", solution.iterations},
        {"seconds", solution.seconds},
        {"converged", solution.converged},
        {"solver", name_of(solution.solver)},
        {"vertices", graph.T_world_vertex.size()},
        {"edges", graph.edges.size()},
        {"parts", parts},
        {"repaired_edges", file.repaired_lines.size()},
    };
    fmt::print(to, "{}\n", ordered_json_text(figures, 2));
    return;
  }
  fmt::print(to, "graph       {} vertices, {} edges\n", graph.T_world_vertex.size(), graph.edges.size());
  fmt::print(to, "solver      {}: {} iterations, {:.3f} s{}\n", name_of(solution.solver), solution.iterations,
             solution.seconds, solution.converged ? "" : ", not converged");
  fmt::print(to, "chi2        {} -> {}\n", solution.chi2_before, solution.chi2_after);
}

void optimize(const OptimizeArguments& arguments) {
  const PoseGraphOptions options = pose_graph_options(arguments);
  check_outputs(arguments);
  G2oFile file = read_g2o(arguments.input);
  std::visit(
      [&](auto& graph) {
        const size_t parts = count_connected_components(graph);
        warn_about(file, parts, arguments.input);
        auto solution = solve_pose_graph(graph, options);
        const auto before = std::exchange(graph.T_world_vertex, solution.T_world_vertex);
        write_g2o(arguments.output, file);
        if (!arguments.report.empty()) {
          write_file(arguments.report, page(arguments.input.string(), before, graph, solution));
        }
        print(graph, solution, parts, file, arguments);
      },
      file.graph);
}

}  // namespace

void add_optimize_command(CLI::App& app) {
  auto arguments = std::make_shared<OptimizeArguments>();
  CLI::App* command = app.add_subcommand("optimize", "Optimise the pose graph of a .g2o file");
  command->footer(kOptimizeFooter);
  command->add_option("input", arguments->input, "the graph")->required()->type_name("IN.g2o");
  command->add_option("-o,--output", arguments->output, "file for the optimised graph")
      ->required()
      ->type_name("OUT.g2o");
  command->add_option("--report", arguments->report, "HTML report with the graph before and after")
      ->type_name("OUT.html");
  command->add_option("--solver", arguments->solver, "auto (the built-in one), builtin, ceres or g2o");
  command->add_option("--method", arguments->method, "auto, levenberg, gauss-newton or dogleg");
  command->add_option("--start", arguments->start,
                      "auto, given (the poses of the file), tree (chained along a spanning tree) or chordal "
                      "(rotations, then translations, by linear least squares)");
  command->add_option("--robust", arguments->robust,
                      "robust kernel against false loop edges: none, huber, cauchy, geman-mcclure or dcs");
  command->add_option("--robust-width", arguments->robust_width, "kernel width in standard deviations");
  command->add_option("--iterations", arguments->iterations, "maximum number of iterations");
  command->add_flag("--overwrite", arguments->overwrite, "allow -o to overwrite the input file");
  command->add_flag("--json", arguments->json, "print the figures as JSON");
  command->callback([arguments] { optimize(*arguments); });
}

}  // namespace kinloop
