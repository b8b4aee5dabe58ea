#pragma once
// In: two map files of one place. Out: both in one frame, and what differs between them.

#include "apps/map/merge_maps.hpp"
#include "dense/up_direction.hpp"
#include "tools/map_difference/map_difference.hpp"
#include "viewer/saved/comparison.hpp"

namespace kinloop {

struct ComparedMaps {
  MergedMaps merged;                         ///< the world frame is that of `a`
  std::vector<PosedImage> views_a, views_b;  ///< of the part of the map that holds most of both
  ColoredCloud before, after;                ///< of `a` and `b`
  MapDifference difference;
  UpEstimate up;

  /// Returns the frame of files, z up.
  [[nodiscard]] FileFrame file_frame() const { return kinloop::file_frame("z-up", up, views_a); }
};

/// Joins both maps as `merge_maps` does, and compares them. Throws InputError if nothing of one was
/// recognised in the other, or one holds no images; what `throw_if_interrupted` throws on an interrupt.
ComparedMaps compare_maps(const MergeRequest& request, const Progress& progress);

/// Returns what a page shows of them.
Comparison comparison_of(const ComparedMaps& compared, const MergeRequest& request);

}  // namespace kinloop
