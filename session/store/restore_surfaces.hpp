#pragma once
// In: a saved map, and the depth images in its file. Out: keyframes that know the surfaces in their view, so
// that joins of maps can be judged as those of visits in one run.

#include "kinloop/io/map_file/map_file.hpp"

namespace kinloop {

/// Sets the surfaces of the keyframes whose images are in the file. They are those of the depth image, also
/// of what moved: it was masked in the run, and the file does not tell where.
void restore_surfaces(SavedMap& saved, const MapReader& reader);

}  // namespace kinloop
