#pragma once
// In: a whole cloud. Out: the pieces in which a browser takes it.

#include <vector>

#include "viewer/scene/wire_format.hpp"

namespace kinloop {

/// Every piece is a sample of the whole, so that thinned ones show no stripes. Points far outside are in
/// pieces of their own: the finest step of a piece follows from its size.
std::vector<CloudPiece> split_into_pieces(const ColoredCloud& cloud);

}  // namespace kinloop
