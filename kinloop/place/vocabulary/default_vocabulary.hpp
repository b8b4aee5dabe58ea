#pragma once
// The vocabulary embedded in the library.

#include "kinloop/place/vocabulary/vocabulary.hpp"

namespace kinloop {

/// Returns the default ORB vocabulary: kinloop/place/vocabulary/orb.kinvoc at build time.
Vocabulary load_default_vocabulary();

}  // namespace kinloop
