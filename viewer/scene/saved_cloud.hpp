#pragma once
// In: a whole cloud. Out: the pieces sent to browsers.

#include <vector>

#include "viewer/scene/wire_format.hpp"

namespace kinloop {

/// Splits a cloud so that every piece is a sample of the whole; thinning then shows no stripes. Points far
/// outside get separate pieces, since the resolution of a piece follows from its size.
std::vector<CloudPiece> split_into_pieces(const ColoredCloud& cloud);

}  // namespace kinloop
