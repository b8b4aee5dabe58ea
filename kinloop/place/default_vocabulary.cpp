#include "kinloop/place/default_vocabulary.hpp"

#include "kinloop/place/vocabulary_file.hpp"

// The assembler copies the file into the library's read-only data: no file to find at run time, no array of a
// million numbers for the compiler to read.
__asm__(
    ".pushsection .rodata\n"
    ".balign 8\n"
    ".global kinloop_default_vocabulary_begin\n"
    "kinloop_default_vocabulary_begin:\n"
    ".incbin \"" KINLOOP_DEFAULT_VOCABULARY
    "\"\n"
    ".global kinloop_default_vocabulary_end\n"
    "kinloop_default_vocabulary_end:\n"
    ".popsection\n");

extern "C" {
extern const char kinloop_default_vocabulary_begin[];
extern const char kinloop_default_vocabulary_end[];
}

namespace kinloop {

Vocabulary load_default_vocabulary() {
  const auto bytes = static_cast<size_t>(kinloop_default_vocabulary_end - kinloop_default_vocabulary_begin);
  return parse_vocabulary({kinloop_default_vocabulary_begin, bytes},
                          "the built-in dictionary (data/orb.kinvoc)");
}

}  // namespace kinloop
