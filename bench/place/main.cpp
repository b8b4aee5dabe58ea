// bench_place: measures the quality of vocabularies. Photographs come from the shared data next to the
// project.
//
//   bench_place compare K L FLAT STEP SEQUENCE...
//       compares seeding methods over five seeds; writes the curves to place_curves.svg
//   bench_place search STEP SEQUENCE...
//       the same places without a vocabulary: brute force, FLANN's LSH and Kd trees
//   bench_place detect STEP SEQUENCE...
//       the detector with verification, over five vocabularies by random seeding and by k-means++
//   bench_place scale [IMAGES]
//       times: opening, words, queries up to IMAGES (200000) images
//
// K, L: branching and depth of the trees; FLAT: 1 = also a flat vocabulary of K^L words; STEP: every STEP-th
// frame. Sequences must be of different scenes.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/place/raw_search.hpp"
#include "bench/place/recognizers.hpp"
#include "bench/place/scale.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "tools/vocabulary_training/trainer.hpp"
#include "tools/vocabulary_training/vocabulary_stats.hpp"
#include "viewer/report/svg_plot.hpp"

namespace kinloop {
namespace {

constexpr int kSeeds = 5;
const std::filesystem::path kPhotographs = std::filesystem::path(KINLOOP_SHARED_DATA) / "vocabulary_images";

/// Sequences and photographs as one set.
struct World {
  std::vector<Place> places;
  PinholeCamera camera;
};

World read_world(const std::vector<std::string>& sequences, size_t step) {
  World world;
  for (const auto& sequence : sequences) {
    const auto scene = read_places(sequence, world.places.size(), step, world.camera);
    world.places.insert(world.places.end(), scene.begin(), scene.end());
  }
  const size_t images = world.places.size();
  const auto photographs = read_distractors(kPhotographs, images);
  world.places.insert(world.places.end(), photographs.begin(), photographs.end());
  fmt::print("{} images, {} of them with a findable place, and {} photographs of other places\n\n", images,
             count_queries_with_answer(world.places), photographs.size());
  return world;
}

/// "mean (lowest - highest)" of one figure over seeds.
std::string spread(std::vector<double> values, int digits) {
  std::sort(values.begin(), values.end());
  double sum = 0;
  for (const double value : values) sum += value;
  const double mean = sum / static_cast<double>(values.size());
  if (values.size() == 1) return fmt::format("{:.{}f}", mean, digits);
  return fmt::format("{:.{}f} ({:.{}f} - {:.{}f})", mean, digits, values.front(), digits, values.back(),
                     digits);
}

/// Figures of one method over seeds.
struct Row {
  std::string name;
  std::vector<double> error_bits, training_s, words_ms, query_ms, recall, strict, verified;
};

constexpr const char* kHead =
    "| vocabulary | error, bits | training, s CPU | words, ms | query, ms | recall at 100 % | ... strict | "
    "... "
    "by arrangement |\n|---|---|---|---|---|---|---|---|\n";

void print(const Row& row) {
  const auto cell = [](const std::vector<double>& values, int digits) {
    return values.empty() ? std::string("-") : spread(values, digits);
  };
  fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} |\n", row.name, cell(row.error_bits, 2),
             cell(row.training_s, 1), cell(row.words_ms, 2), cell(row.query_ms, 2), cell(row.recall, 3),
             cell(row.strict, 3), cell(row.verified, 3));
  std::fflush(stdout);
}

/// The curve of one seed; the first has the method's name in the legend.
PlotSeries series_of(const std::string& name, const std::string& style, const Curve& curve) {
  PlotSeries series{style, name, SeriesKind::kLine, {}};
  for (size_t i = 0; i < curve.recall.size(); ++i)
    series.points.emplace_back(curve.recall[i], curve.precision[i]);
  return series;
}

void add_recognition(Row& row, std::span<const Place> places, const Recognition& recognition) {
  const Curve curve = curve_of(places, recognition.answers);
  row.query_ms.push_back(recognition.query_ms);
  row.recall.push_back(curve.recall_without_error);
  row.strict.push_back(curve.strict_recall);
}

std::vector<cv::Mat> descriptors_of(std::span<const Place> places) {
  std::vector<cv::Mat> descriptors;
  for (const Place& place : places) {
    if (place.T_scene_camera) descriptors.push_back(place.features.descriptors);
  }
  return descriptors;
}

struct TrainingMethod {
  std::string name;
  TrainOptions options;
  std::string style = {};  ///< of its curves in the plot; empty: not plotted
};

std::vector<TrainingMethod> training_methods(int branching, int depth, bool flat) {
  TrainOptions tree;
  tree.branching = branching;
  tree.depth = depth;
  const auto seeded = [&](Seeding seeding, int candidates) {
    TrainOptions options = tree;
    options.seeding = seeding;
    options.candidates = candidates;
    return options;
  };
  std::vector<TrainingMethod> methods = {{"random", seeded(Seeding::kRandom, 0), "random"},
                                         {"k-means++, plain", seeded(Seeding::kKmeansPlusPlus, 1)},
                                         {"k-means++, greedy", seeded(Seeding::kKmeansPlusPlus, 0), "greedy"},
                                         {"k-means\\|\\|", seeded(Seeding::kKmeansParallel, 0)}};
  if (flat) {
    TrainOptions options = seeded(Seeding::kKmeansParallel, 1);
    options.branching = static_cast<int>(std::lround(std::pow(branching, depth)));
    options.depth = 1;
    methods.push_back({"flat, k-means\\|\\|", options});
  }
  return methods;
}

Row measure(const TrainingMethod& method, const World& world, std::span<const cv::Mat> training,
            std::vector<Curve>& curves) {
  Row row{method.name, {}, {}, {}, {}, {}, {}, {}};
  const auto descriptors = descriptors_of(world.places);
  for (int seed = 1; seed <= kSeeds; ++seed) {
    TrainOptions options = method.options;
    options.seed = seed;
    const Stopwatch watch;
    const Vocabulary vocabulary = train_vocabulary(training, options);
    row.training_s.push_back(watch.cpu_s());
    row.error_bits.push_back(quantization_error(vocabulary, descriptors));
    const Stopwatch words;
    for (const auto& image : descriptors) (void)vocabulary.quantize(image);
    row.words_ms.push_back(1000 * words.cpu_s() / static_cast<double>(descriptors.size()));
    const Recognition recognition = by_words(world.places, vocabulary);
    add_recognition(row, world.places, recognition);
    curves.push_back(curve_of(world.places, recognition.answers));
    const auto verified = by_geometric_verification(world.places, vocabulary);
    row.verified.push_back(curve_of(world.places, verified.answers).recall_without_error);
  }
  return row;
}

void write_curves(const std::vector<PlotSeries>& series) {
  const PlotAxes frame{"Precision and recall of place recognition", "recall", "precision", false, false};
  std::string svg = svg_plot(frame, series);
  const std::string style =
      " xmlns=\"http://www.w3.org/2000/svg\"><style>text{font:12px sans-serif;fill:#444}"
      "svg{background:#fff}.grid{stroke:#ddd}.random{stroke:#999;fill:#999}"
      ".greedy{stroke:#1f6fb4;fill:#1f6fb4}"
      "polyline,path{fill:none!important;stroke-width:1.5}</style>";
  svg.insert(svg.find('>'), style);
  svg.erase(svg.find("</style>") + 8, 1);
  write_file("place_curves.svg", svg);
}

void compare(int branching, int depth, bool flat, const World& world) {
  const auto training = read_training_images(kPhotographs);
  fmt::print("{}", kHead);
  std::vector<PlotSeries> series;
  for (const TrainingMethod& method : training_methods(branching, depth, flat)) {
    std::vector<Curve> curves;
    print(measure(method, world, training, curves));
    if (method.style.empty()) continue;
    for (const Curve& curve : curves) {
      series.push_back(series_of(&curve == &curves.front() ? method.name : "", method.style, curve));
    }
  }
  write_curves(series);
}

/// Place recognition without a vocabulary.
void search(const World& world) {
  fmt::print("{}", kHead);
  Row brute{"none: brute force", {}, {}, {}, {}, {}, {}, {}};
  add_recognition(brute, world.places, by_brute_force(world.places));
  print(brute);
  Row lsh{"none: FLANN, LSH", {}, {}, {}, {}, {}, {}, {}};
  Row trees{"none: FLANN, Kd trees", {}, {}, {}, {}, {}, {}, {}};
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    add_recognition(lsh, world.places, by_lsh(world.places, seed));
    add_recognition(trees, world.places, by_kd_trees(world.places, seed));
  }
  print(lsh);
  print(trees);
}

void run_detector(const World& world) {
  const auto training = read_training_images(kPhotographs);
  fmt::print(
      "| seeding | seed | confirmed | of those findable | pose off | another scene "
      "|\n|---|---|---|---|---|---|\n");
  for (const TrainingMethod& method : training_methods(32, 3, false)) {
    if (method.style.empty()) continue;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      TrainOptions options = method.options;
      options.seed = seed;
      options.threads = hardware_threads();
      const auto detection = detect(world.places, train_vocabulary(training, options), world.camera);
      fmt::print(
          "| {} | {} | {} | {} of {} = {:.3f} | {} | {} |\n", method.name, seed, detection.confirmed,
          detection.same, count_queries_with_answer(world.places),
          static_cast<double>(detection.same) / static_cast<double>(count_queries_with_answer(world.places)),
          detection.off, detection.other_scene);
      std::fflush(stdout);
    }
  }
}

int run(const std::vector<std::string>& arguments) {
  const std::string mode = arguments.empty() ? "" : arguments[0];
  const auto world_from = [&](size_t step) {
    return read_world({arguments.begin() + static_cast<std::ptrdiff_t>(step) + 1, arguments.end()},
                      std::stoul(arguments[step]));
  };
  if (mode == "compare" && arguments.size() >= 6) {
    compare(std::stoi(arguments[1]), std::stoi(arguments[2]), arguments[3] == "1", world_from(4));
  } else if (mode == "search" && arguments.size() >= 3) {
    search(world_from(1));
  } else if (mode == "detect" && arguments.size() >= 3) {
    run_detector(world_from(1));
  } else if (mode == "scale") {
    measure_scale(kPhotographs, arguments.size() > 1 ? std::stoul(arguments[1]) : 200'000);
  } else {
    fmt::print(stderr,
               "usage: bench_place compare K L FLAT STEP SEQUENCE... | search STEP SEQUENCE... | detect STEP "
               "SEQUENCE... | scale [IMAGES]\n");
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace kinloop

int main(int argc, char** argv) {
  try {
    return kinloop::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 3;
  }
}
