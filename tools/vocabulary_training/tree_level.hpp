#pragma once
// One level of the tree while it grows: which descriptors are whose.

#include <vector>

#include "tools/vocabulary_training/communicator.hpp"
#include "tools/vocabulary_training/training_set.hpp"

namespace kinloop {

/// A node that is next to be split.
struct TreeLevelNode {
  static constexpr int kAllProcesses = -1;  ///< each process has some of the points

  size_t begin = 0;  ///< of its points in the training set of this process
  size_t end = 0;
  uint64_t total = 0;         ///< points of all processes; known to the owner alone where there is one
  int owner = kAllProcesses;  ///< the process that has all its points, and splits it and all nodes below

  [[nodiscard]] size_t size() const { return end - begin; }
  [[nodiscard]] bool shared() const { return owner == kAllProcesses; }
};

/// Gives each shared node of at most `small` points an owner and sends the points there, in the order of the
/// processes: the owner has them in the order in which one process alone would.
void distribute_nodes(TrainingSet& set, std::vector<TreeLevelNode>& level, uint64_t small,
                      const Communicator& communicator);

}  // namespace kinloop
