#pragma once
// In: surface points and images. Out: a colour for each point, dominated by the images that see it best:
// sharp, close and frontal.

#include <optional>
#include <span>
#include <vector>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/image_store.hpp"
#include "dense/posed_image.hpp"
#include "kinloop/core/progress.hpp"

namespace kinloop {

/// Returns nullopt for a point that no image sees. The result does not depend on `threads`.
std::vector<std::optional<Rgb>> observed_colors(std::span<const Eigen::Vector3f> points,
                                                std::span<const Eigen::Vector3f> normals,
                                                const StoredViews& stored, int threads,
                                                const Progress& progress = {});

/// Same, with grey for a point that no image sees.
std::vector<Rgb> color_points(std::span<const Eigen::Vector3f> points,
                              std::span<const Eigen::Vector3f> normals, const StoredViews& stored,
                              int threads, const Progress& progress = {});

}  // namespace kinloop
