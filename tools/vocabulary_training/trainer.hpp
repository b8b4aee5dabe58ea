#pragma once
// In: the descriptors of many images. Out: a vocabulary, by hierarchical k-means (Nister and Stewenius 2006),
// or with one level a flat one.

#include <span>
#include <string>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/options.hpp"
#include "kinloop/core/progress.hpp"
#include "kinloop/place/vocabulary/vocabulary.hpp"
#include "tools/vocabulary_training/clustering/clustering.hpp"
#include "tools/vocabulary_training/communicator.hpp"
#include "tools/vocabulary_training/descriptors/training_set.hpp"

namespace kinloop {

struct TrainOptions {
  int branching = 10;
  int depth = 5;
  Seeding seeding = Seeding::kKmeansPlusPlus;
  int candidates = 0;
  int iterations = 20;
  int min_split = 2;
  int seed = 1;
  int threads = 1;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("branching", self.branching, "maximum children per node", Range{2, 1e6});
    visit("depth", self.depth, "levels below the root; at most branching^depth words; 1 = a flat vocabulary",
          Range{1, 10});
    visit("seeding", self.seeding, "how the initial cluster centres of a node are chosen");
    visit("candidates", self.candidates,
          "points tried for each k-means++ centre, the best is kept; 0 = 2 + ln(branching), 1 = plain "
          "k-means++",
          Range{0, 100});
    visit("iterations", self.iterations, "maximum Lloyd iterations per node", Range{0, 1000});
    visit("min_split", self.min_split, "minimum descriptors for a node to be split", Range{2, 1e6});
    visit("seed", self.seed, "random seed", Range{0, 2147483647});
    visit("threads", self.threads, "threads; the result does not depend on it", Range{1, 1024});
  }
};

/// Trains on the descriptors of all processes of `communicator`. The same input and seed give the same
/// vocabulary, in each process, for any number of threads and processes. If `progress` asks to stop, nodes
/// not yet split stay words. Throws InputError, in each process, if there are too few descriptors to reach
/// the last level, or fewer than two images.
Vocabulary train_vocabulary(TrainingSet set, const TrainOptions& options, const Progress& progress = {},
                            const Communicator& communicator = Communicator());

/// Trains on the ORB descriptors of each image.
Vocabulary train_vocabulary(std::span<const cv::Mat> descriptors_of_images, const TrainOptions& options,
                            const Progress& progress = {});

}  // namespace kinloop
