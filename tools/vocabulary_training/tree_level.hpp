#pragma once
// One level of the growing tree, with its points distributed over processes.

#include <vector>

#include "tools/vocabulary_training/communicator.hpp"
#include "tools/vocabulary_training/descriptors/training_set.hpp"

namespace kinloop {

/// A node to be split next.
struct TreeLevelNode {
  static constexpr int kAllProcesses = -1;  ///< each process has some of the points

  size_t begin = 0;  ///< of its points in the local training set
  size_t end = 0;
  uint64_t total = 0;         ///< points in all processes; if there is an owner, known to it alone
  int owner = kAllProcesses;  ///< the process that has all its points and splits it and all nodes below

  [[nodiscard]] size_t size() const { return end - begin; }
  [[nodiscard]] bool shared() const { return owner == kAllProcesses; }
};

/// Assigns each shared node of at most `small` points an owner and sends the points there in process order,
/// so that the owner has them in the same order as a single process would.
void distribute_nodes(TrainingSet& set, std::vector<TreeLevelNode>& level, uint64_t small,
                      const Communicator& communicator);

}  // namespace kinloop
