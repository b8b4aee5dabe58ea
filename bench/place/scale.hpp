#pragma once

#include <filesystem>

namespace kinloop {

/// Prints the cost of opening the default vocabulary, of quantising an image, and of queries as the index
/// grows by synthetic images up to `most_images`.
void measure_scale(const std::filesystem::path& photographs, size_t most_images);

}  // namespace kinloop
