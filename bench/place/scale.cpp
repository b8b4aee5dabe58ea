#include "bench/place/scale.hpp"

#include <algorithm>
#include <cstdio>
#include <vector>

#include <fmt/format.h>

#include "bench/place/places.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/place/place_index.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"

namespace kinloop {
namespace {

/// Times `work`, which receives the number of the run.
template <class Work>
double median_ms_of(int runs, const Work& work) {
  std::vector<double> seconds;
  for (int run = 0; run < runs; ++run) {
    const Stopwatch watch;
    work(run);
    seconds.push_back(watch.cpu_s());
  }
  return 1000 * median(seconds);
}

/// The words of a synthetic image, drawn from those of real ones.
BowVector shuffled_image(const std::vector<WordId>& words, const Vocabulary& vocabulary, Random& random) {
  constexpr size_t kFeatures = 1000;
  std::vector<WordId> drawn(kFeatures);
  for (WordId& word : drawn) word = words[random.index(static_cast<uint32_t>(words.size()))];
  return vocabulary.bow_of(drawn);
}

}  // namespace

void measure_scale(const std::filesystem::path& photographs, size_t most_images) {
  const Vocabulary vocabulary = load_default_vocabulary();
  fmt::print("opening the default vocabulary: {:.2f} ms CPU\n",
             median_ms_of(21, [](int) { (void)load_default_vocabulary(); }));
  const auto images = read_distractors(photographs, 0);
  const cv::Mat thousand = std::max_element(images.begin(), images.end(), [](const auto& a, const auto& b) {
                             return a.features.descriptors.rows < b.features.descriptors.rows;
                           })->features.descriptors;
  fmt::print("words of {} features: {:.2f} ms CPU\n\n", thousand.rows,
             median_ms_of(101, [&](int) { (void)vocabulary.quantize(thousand); }));
  std::vector<WordId> words;
  for (const Place& image : images) {
    const auto of_image = vocabulary.quantize(image.features.descriptors).words;
    words.insert(words.end(), of_image.begin(), of_image.end());
  }
  Random random(1);
  PlaceIndex index;
  const size_t real = images.size();
  for (size_t i = 0; i < real; ++i) {
    const auto of_image = vocabulary.quantize(images[i].features.descriptors).words;
    index.add({static_cast<uint32_t>(i)}, vocabulary.bow_of(of_image));
  }
  fmt::print("| images | query, ms CPU | half of the words found again |\n|---|---|---|\n");
  for (const size_t size : {1000U, 5000U, 20'000U, 50'000U, 100'000U, 200'000U}) {
    if (size > most_images) break;
    while (index.size() < size) {
      index.add({static_cast<uint32_t>(index.size())}, shuffled_image(words, vocabulary, random));
    }
    size_t found = 0;
    // Half of the words of a real image, as after a small sideways motion.
    std::vector<BowVector> queries;
    for (size_t i = 0; i < real; ++i) {
      const auto of_image = vocabulary.quantize(images[i].features.descriptors).words;
      queries.push_back(vocabulary.bow_of(std::span(of_image).first(of_image.size() / 2)));
    }
    const double ms = median_ms_of(static_cast<int>(real), [&](int run) {
      const auto best = index.query(queries[static_cast<size_t>(run)], 1);
      if (!best.empty() && best[0].keyframe.value == static_cast<uint32_t>(run)) ++found;
    });
    const double whole_ms = median_ms_of(static_cast<int>(real), [&](int run) {
      (void)index.query(index.bow_of({static_cast<uint32_t>(run)}), 5);
    });
    fmt::print("| {} | {:.2f} | {} of {} |\n", size, std::max(ms, whole_ms), found, real);
    std::fflush(stdout);
  }
}

}  // namespace kinloop
