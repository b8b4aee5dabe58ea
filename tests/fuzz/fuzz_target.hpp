#pragma once
// A fuzz target: a reader that gets any bytes. libFuzzer runs it (libfuzzer/main.cpp), and the test replays
// its corpus in every build.

#include <span>
#include <string_view>

namespace kinloop::fuzz {

struct FuzzTarget {
  const char* name;  ///< also the folder of its corpus
  /// Reads the bytes. Returns if they were read or rejected with an InputError of one line; any other
  /// exception is a defect.
  void (*run)(std::string_view bytes);
};

/// All targets, in alphabetical order.
std::span<const FuzzTarget> fuzz_targets();

/// Returns the target of this name; null if there is none.
const FuzzTarget* find_target(std::string_view name);

}  // namespace kinloop::fuzz
