// All targets as one libFuzzer program, which is linked once. KINLOOP_FUZZ_TARGET names the target.

#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "kinloop/core/log.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/libfuzzer/mutate_map.hpp"

namespace {

const kinloop::fuzz::FuzzTarget& chosen_target() {
  static const auto* const kTarget = [] {
    const char* name = std::getenv("KINLOOP_FUZZ_TARGET");
    const auto* found = kinloop::fuzz::find_target(name == nullptr ? "" : name);
    if (found != nullptr) return found;
    std::fputs("KINLOOP_FUZZ_TARGET must be one of:\n", stderr);
    for (const auto& target : kinloop::fuzz::fuzz_targets()) std::fprintf(stderr, "  %s\n", target.name);
    std::exit(2);
  }();
  return *kTarget;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  kinloop::log::set_level(spdlog::level::off);
  static_cast<void>(chosen_target());
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  chosen_target().run({reinterpret_cast<const char*>(data), size});
  return 0;
}

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned seed) {
  static const bool kIsMap = std::string_view(chosen_target().name) == "map";
  return kIsMap ? kinloop::fuzz::mutate_map(data, size, max_size, seed)
                : LLVMFuzzerMutate(data, size, max_size);
}
