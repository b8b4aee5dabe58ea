#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "apps/reproduce/chapters.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/quantile.hpp"

namespace kinloop {
namespace {

constexpr int kSeeds = 3;

/// A way to choose the initial centres.
struct Seeding {
  const char* name;
  const char* init;
  const char* candidates;
};
constexpr std::array<Seeding, 4> kSeedings = {{{"random", "random", "0"},
                                               {"k-means++", "kmeans++", "1"},
                                               {"greedy k-means++", "kmeans++", "0"},
                                               {"k-means\\|\\|", "kmeans||", "0"}}};

/// The number after `name` in the output of `vocab train`.
double figure_of(const std::string& output, const std::string& name) {
  const size_t at = output.find(name);
  if (at == std::string::npos) throw InputError("kinloop vocab train: no " + name);
  return std::stod(output.substr(at + name.size()));
}

/// Images that are not trained on: the sequence, or a second simulated room.
std::string held_out_images(Chapter& chapter, const ReproduceFolder& folder) {
  if (!folder.arguments.images.empty()) return folder.sequence;
  std::string room = folder.at("room2");
  run_program(chapter, {"simulate", "room", "--seed", "2", "--frames", "60", "-q", "-o", room});
  return room;
}

}  // namespace

Chapter vocabulary_chapter(const ReproduceFolder& folder) {
  Chapter chapter;
  chapter.title = "Vocabulary: how k-means starts";
  chapter.text = fmt::format(
      "The paper prefers k-means++ for the visual words. Mean distance in bits from a descriptor of held-out "
      "images to its word, over {} seeds; 10 children, 4 levels.",
      kSeeds);
  const std::string held_out = held_out_images(chapter, folder);
  const std::string images =
      folder.arguments.images.empty() ? folder.sequence : folder.arguments.images.string();
  const std::string descriptors = folder.at("descriptors.kindesc");
  run_program(chapter, {"vocab", "describe", images, "--count", "500", "-q", "-o", descriptors});
  MarkdownTable table{
      {"initial centres", "held-out error, bits: median", "lowest", "highest", "seconds, median"}};
  for (const Seeding& seeding : kSeedings) {
    std::vector<double> errors, seconds;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      const std::string output =
          run_program(chapter, {"vocab", "train", descriptors, "-k", "10", "-L", "4", "--init", seeding.init,
                                "--candidates", seeding.candidates, "--seed", std::to_string(seed),
                                "--held-out", held_out, "-q", "-o", folder.at("words.kinvoc")});
      errors.push_back(figure_of(output, "held-out error "));
      seconds.push_back(figure_of(output, "s for descriptors, "));
    }
    std::sort(errors.begin(), errors.end());
    table.push_back({seeding.name, fmt::format("{:.3f}", median(errors)),
                     fmt::format("{:.3f}", errors.front()), fmt::format("{:.3f}", errors.back()),
                     fmt::format("{:.2f}", median(seconds))});
    chapter.figures[seeding.name] = {{"held_out_error_bits", errors}, {"seconds", seconds}};
  }
  chapter.tables.push_back(table);
  return chapter;
}

}  // namespace kinloop
