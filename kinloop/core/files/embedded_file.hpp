#pragma once
// Files embedded in the program, so that there is nothing to find at run time. The assembler copies the file
// into read-only data, which spares the compiler an array of a million numbers.

#include <cstddef>
#include <string_view>

/// Defines `std::string_view NAME()`, which returns the bytes of the file `PATH` (a string literal). Use it
/// at namespace scope in a .cpp file; CMake must be told that the object depends on the file.
// NOLINTBEGIN(bugprone-macro-parentheses): pastes names and string literals
#define KINLOOP_EMBED_FILE(NAME, PATH)                                                             \
  __asm__(                                                                                         \
      ".pushsection .rodata\n"                                                                     \
      ".balign 8\n"                                                                                \
      ".global kinloop_embedded_" #NAME "_begin\nkinloop_embedded_" #NAME                          \
      "_begin:\n"                                                                                  \
      ".incbin \"" PATH                                                                            \
      "\"\n"                                                                                       \
      ".global kinloop_embedded_" #NAME "_end\nkinloop_embedded_" #NAME                            \
      "_end:\n"                                                                                    \
      ".popsection\n");                                                                            \
  extern "C" const char kinloop_embedded_##NAME##_begin[];                                         \
  extern "C" const char kinloop_embedded_##NAME##_end[];                                           \
  static std::string_view NAME() {                                                                 \
    return {kinloop_embedded_##NAME##_begin,                                                       \
            static_cast<size_t>(kinloop_embedded_##NAME##_end - kinloop_embedded_##NAME##_begin)}; \
  }
// NOLINTEND(bugprone-macro-parentheses)
