// bench_graphs: compares the three pose graph solvers in one run.
//
//   bench_graphs standard [DIR]   every .g2o file in DIR: from the file's start, from none, from a noisy one
//   bench_graphs growth [MAX]     made-up graphs of 1000 poses and more, up to MAX (100000)
//   bench_graphs outliers [DIR]   false loop edges: error against the clean solution, by robust kernel

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>

#include "bench/graph_worlds.hpp"
#include "tools/export/g2o/g2o_file.hpp"

namespace kinloop {
namespace {

constexpr int kRuns = 3;      // the median is reported ...
constexpr double kLongS = 1;  // ... but one run suffices if it takes longer than this

/// CPU time of all threads so far, since CHOLMOD and BLAS under g2o may start some.
double process_cpu_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// A solver with its settings.
struct SolverSetup {
  PoseGraphSolver solver;
  PoseGraphMethod method;
  PoseGraphStart start;
};

// g2o's command line starts from a spanning tree on request; both starts are compared.
constexpr SolverSetup kSetups[] = {
    {PoseGraphSolver::kBuiltin, PoseGraphMethod::kAuto, PoseGraphStart::kAuto},
    {PoseGraphSolver::kCeres, PoseGraphMethod::kLevenberg, PoseGraphStart::kGiven},
    {PoseGraphSolver::kCeres, PoseGraphMethod::kLevenberg, PoseGraphStart::kTree},
    {PoseGraphSolver::kG2o, PoseGraphMethod::kLevenberg, PoseGraphStart::kGiven},
    {PoseGraphSolver::kG2o, PoseGraphMethod::kLevenberg, PoseGraphStart::kTree},
    {PoseGraphSolver::kG2o, PoseGraphMethod::kGaussNewton, PoseGraphStart::kGiven},
    {PoseGraphSolver::kG2o, PoseGraphMethod::kGaussNewton, PoseGraphStart::kTree},
    {PoseGraphSolver::kG2o, PoseGraphMethod::kDogleg, PoseGraphStart::kGiven},
    {PoseGraphSolver::kG2o, PoseGraphMethod::kDogleg, PoseGraphStart::kTree},
};

struct Figures {
  double chi2 = 0;
  double wall_s = 0, cpu_s = 0;
  int iterations = 0;
};

template <class Pose>
Figures measure(const BasicPoseGraph<Pose>& graph, const SolverSetup& setup) {
  PoseGraphOptions options;
  options.solver = setup.solver;
  options.method = setup.method;
  options.start = setup.start;
  Figures figures;
  std::vector<double> walls, cpus;
  while (walls.size() < kRuns && (cpus.empty() || cpus.back() < kLongS)) {
    const double start_s = process_cpu_s();
    const auto solution = solve_pose_graph(graph, options);
    cpus.push_back(process_cpu_s() - start_s);
    walls.push_back(solution.seconds);
    figures.chi2 = solution.chi2_after;
    figures.iterations = solution.iterations;
  }
  std::sort(walls.begin(), walls.end());
  std::sort(cpus.begin(), cpus.end());
  figures.wall_s = walls[walls.size() / 2];
  figures.cpu_s = cpus[cpus.size() / 2];
  return figures;
}

/// Skips combinations that make no sense: the spanning tree ignores noise, and "none" means no given start.
bool is_included(const SolverSetup& setup, const std::string& start) {
  return pose_graph_solver_available(setup.solver) &&
         !(start == "noisy" && setup.start == PoseGraphStart::kTree) &&
         !(start == "none" && setup.start == PoseGraphStart::kGiven);
}

template <class Pose>
void compare(const std::string& name, const BasicPoseGraph<Pose>& graph, const std::string& start) {
  for (const SolverSetup& setup : kSetups) {
    if (!is_included(setup, start)) continue;
    const Figures figures = measure(graph, setup);
    fmt::print("{:26} {:5} {:8} {:13} {:6} chi2 {:<18.10g} {:4} iterations {:8.4f} s, {:8.4f} s of CPU\n",
               name, start, name_of(setup.solver), name_of(setup.method), name_of(setup.start), figures.chi2,
               figures.iterations, figures.wall_s, figures.cpu_s);
    std::fflush(stdout);
  }
}

std::vector<std::filesystem::path> graphs_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".g2o") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The graph with the initial poses of a benchmark: "file", "noisy" or "none".
template <class Pose>
BasicPoseGraph<Pose> with_initial_guess(const BasicPoseGraph<Pose>& graph, const std::string& start) {
  constexpr double kNoise = 0.5;  // metres, radians
  if (start == "noisy") return with_noise(graph, kNoise);
  return start == "none" ? without_start(graph) : graph;
}

void run_standard(const std::filesystem::path& folder) {
  for (const std::string start : {"noisy", "none", "file"}) {
    for (const auto& path : graphs_in(folder)) {
      std::visit(
          [&](const auto& graph) { compare(path.stem().string(), with_initial_guess(graph, start), start); },
          read_g2o(path).graph);
    }
  }
}

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void run_scaling(uint32_t most) {
  // The built-in solver goes first, since peak memory only grows. The graph's own start is a spanning tree,
  // which the others would also use without a start.
  constexpr SolverSetup kScalingSetups[] = {
      {PoseGraphSolver::kBuiltin, PoseGraphMethod::kAuto, PoseGraphStart::kAuto},
      {PoseGraphSolver::kG2o, PoseGraphMethod::kDogleg, PoseGraphStart::kGiven},
      {PoseGraphSolver::kCeres, PoseGraphMethod::kLevenberg, PoseGraphStart::kGiven}};
  constexpr uint32_t kMaxFromNoise = 10000;  // beyond, the other solvers take many minutes
  for (uint32_t count = 1000; count <= most; count *= 10) {
    const PoseGraph graph = grid_walk(count);
    for (const SolverSetup& setup : kScalingSetups) {
      if (!pose_graph_solver_available(setup.solver)) continue;
      const bool is_builtin = &setup == &kScalingSetups[0];
      for (const std::string start : {"file", "noisy", "none"}) {
        if (!is_builtin && (start == "none" || (start == "noisy" && count > kMaxFromNoise))) continue;
        const Figures figures = measure(with_initial_guess(graph, start), setup);
        fmt::print(
            "{:7} poses {:7} edges, {:5} {:8} chi2 {:.8g}, {} iterations, {:.3f} s of CPU, peak {:.0f} MiB\n",
            count, graph.edges.size(), start, name_of(setup.solver), figures.chi2, figures.iterations,
            figures.cpu_s, peak_memory_mib());
      }
    }
  }
}

template <class Pose>
double translation_rmse(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i].translation - b[i].translation).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

template <class Pose>
void compare_kernels(const std::string& name, const BasicPoseGraph<Pose>& graph) {
  const auto clean = solve_pose_graph(graph).T_world_vertex;
  for (const double share : {0.1, 0.3}) {
    const auto spoilt = with_false_loops(graph, share);
    for (const auto& [kernel, kernel_name] : option_names(RobustKernel{})) {
      PoseGraphOptions options;
      options.robust_kernel = kernel;
      const auto solution = solve_pose_graph(spoilt, options);
      fmt::print(
          "{:12} {:3.0f} % false loops {:14} {:10.4f} m from the clean solution, {:4} iterations, {:.3f} s\n",
          name, 100 * share, kernel_name, translation_rmse(solution.T_world_vertex, clean),
          solution.iterations, solution.seconds);
    }
  }
}

void run_outliers(const std::filesystem::path& folder) {
  for (const char* name : {"sphere2500", "intel", "manhattan"}) {
    const auto path = folder / (std::string(name) + ".g2o");
    if (!std::filesystem::exists(path)) continue;
    std::visit([&](const auto& graph) { compare_kernels(name, graph); }, read_g2o(path).graph);
  }
}

}  // namespace
}  // namespace kinloop

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  const std::string argument = argc > 2 ? argv[2] : "";
  const std::filesystem::path folder = argument.empty() ? KINLOOP_SHARED_DATA "/pose_graphs" : argument;
  if (mode == "standard") {
    kinloop::run_standard(folder);
  } else if (mode == "growth") {
    kinloop::run_scaling(argument.empty() ? 100000 : static_cast<uint32_t>(std::stoul(argument)));
  } else if (mode == "outliers") {
    kinloop::run_outliers(folder);
  } else {
    fmt::print(stderr, "usage: bench_graphs standard [DIR] | growth [MAX_POSES] | outliers [DIR]\n");
    return 2;
  }
  return 0;
}
