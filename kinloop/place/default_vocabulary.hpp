#pragma once
// The vocabulary that is part of the library.

#include "kinloop/place/vocabulary.hpp"

namespace kinloop {

/// The default ORB vocabulary, data/orb.kinvoc as it was when the library was built.
Vocabulary load_default_vocabulary();

}  // namespace kinloop
