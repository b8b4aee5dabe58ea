#include "drivers/datasets/reading/lists/tum_listing.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace kinloop::fuzz {

void read_frame_lists_bytes(std::string_view bytes) {
  with_folder(bytes, [](const auto& folder) {
    accept([&] {
      const TumListing listing = read_tum_listing(folder);
      for (size_t i = 1; i < listing.frames.size(); ++i)
        require(listing.frames[i].stamp_ns > listing.frames[i - 1].stamp_ns,
                "frames that are not in order of time");
    });
  });
}

}  // namespace kinloop::fuzz
