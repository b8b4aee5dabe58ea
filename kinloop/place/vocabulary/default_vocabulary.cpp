#include "kinloop/place/vocabulary/default_vocabulary.hpp"

#include "kinloop/core/files/embedded_file.hpp"
#include "kinloop/place/vocabulary/vocabulary_file.hpp"

KINLOOP_EMBED_FILE(default_vocabulary, KINLOOP_DEFAULT_VOCABULARY)

namespace kinloop {

Vocabulary load_default_vocabulary() {
  return parse_vocabulary(default_vocabulary(),
                          "the built-in vocabulary (kinloop/place/vocabulary/orb.kinvoc)", nullptr);
}

}  // namespace kinloop
