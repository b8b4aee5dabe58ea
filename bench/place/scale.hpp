#pragma once

#include <filesystem>

namespace kinloop {

/// Prints what opening the default vocabulary, the words of an image, and queries cost as the index grows by
/// images that do not exist, up to `most_images`.
void measure_scale(const std::filesystem::path& photographs, size_t most_images);

}  // namespace kinloop
