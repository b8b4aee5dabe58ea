#pragma once
// Takes back landmarks on things that have moved. Some are recognised as such too late: a person who walks in
// view when the map begins, or who stood still until then. Keyframes made at other times saw through the
// place.

#include "kinloop/map/map.hpp"

namespace kinloop {

/// Erases the landmarks through which at least two keyframes saw, and more than found a surface there. Those
/// that observe a landmark have no say. Landmarks without measured depth stay, and those on things too thin
/// for the surfaces. Returns how many are erased.
size_t erase_moved_landmarks(Map& map);

}  // namespace kinloop
