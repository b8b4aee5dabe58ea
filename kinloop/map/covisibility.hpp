#pragma once
// How many landmarks each keyframe shares with each other one. Kept up to date with every observation, so
// that the graph of a large map needs no search when a loop is closed.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "kinloop/map/keyframe.hpp"

namespace kinloop {

class Covisibility {
 public:
  void add_keyframe() { neighbours_.emplace_back(); }

  /// Counts a landmark that `keyframe` observes besides the `others`.
  void add(KeyframeId keyframe, std::span<const Observation> others) { change(keyframe, others, 1); }

  /// Takes back the same.
  void remove(KeyframeId keyframe, std::span<const Observation> others) { change(keyframe, others, -1); }

  /// Counts a landmark with these observations.
  void add(std::span<const Observation> observations);

  /// Takes back the same.
  void remove(std::span<const Observation> observations);

  /// See Map::covisible_keyframes.
  [[nodiscard]] std::vector<std::pair<KeyframeId, int>> neighbours(KeyframeId keyframe, int min_shared) const;

 private:
  struct Neighbour {
    uint32_t keyframe = 0;
    int32_t shared = 0;
  };
  using Neighbours = std::vector<Neighbour>;  // in order of ids

  void change(KeyframeId keyframe, std::span<const Observation> others, int32_t by);
  static void change(Neighbours& neighbours, KeyframeId other, int32_t by);

  std::vector<Neighbours> neighbours_;  // index = id of the keyframe
};

}  // namespace kinloop
