// bench_bundles: compares the built-in Schur solver with Ceres for bundle adjustment, in one run, on
// simulated windows from local to global.

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "kinloop/core/stopwatch.hpp"
#include "kinloop/optimize/bundle/bundle.hpp"
#include "tests/optimize/bundle_world.hpp"

namespace kinloop {
namespace {

constexpr int kRuns = 3;  // the median is reported

struct Size {
  int poses, points;
};

BundleProblem window(Size size) {
  test::BundleWorldSettings settings{.poses = size.poses,
                                     .points = size.points,
                                     .sigma_px = 0.8,
                                     .sigma_inverse_depth = 2e-3,
                                     .outlier_fraction = 0.03};
  test::BundleWorld world = make_bundle_world(settings);
  constexpr double kShiftM = 0.02, kTurnRad = 0.01;
  perturb(world, kShiftM, kTurnRad);
  return world.problem;
}

void compare(const BundleProblem& problem) {
  for (const auto solver : {BundleSolver::kBuiltin, BundleSolver::kCeres}) {
    BundleOptions options;
    options.solver = solver;
    std::vector<double> cpus_s;
    BundleSolution solution;
    for (int run = 0; run < kRuns; ++run) {
      const Stopwatch stopwatch;
      solution = solve_bundle(problem, options);
      cpus_s.push_back(stopwatch.cpu_s());
    }
    std::sort(cpus_s.begin(), cpus_s.end());
    fmt::print("{:4} keyframes {:6} observations {:8} cost {:<12.8g} {:3} iterations {:9.4f} s of CPU\n",
               problem.T_world_camera.size(), problem.observations.size(), name_of(solver),
               solution.chi2_after, solution.iterations, cpus_s[kRuns / 2]);
  }
}

}  // namespace
}  // namespace kinloop

int main() {
  for (const kinloop::Size size : {kinloop::Size{10, 500}, {20, 1500}, {60, 3000}}) {
    const kinloop::BundleProblem problem = kinloop::window(size);
    kinloop::compare(problem);
  }
  return 0;
}
