#include <opencv2/core.hpp>

#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"
#include "tools/vocabulary_training/descriptors/descriptor_file.hpp"

namespace kinloop::fuzz {

void read_descriptors_bytes(std::string_view bytes) {
  with_file("images.kindesc", bytes, [](const auto& path) {
    accept([&] {
      DescriptorFile file(path);
      for (size_t i = 0; i < file.images(); ++i) static_cast<void>(cv::sum(file.descriptors_of_image(i)));
    });
  });
}

}  // namespace kinloop::fuzz
