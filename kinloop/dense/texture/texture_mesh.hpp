#pragma once
// In: a coloured mesh, and the posed images that it was made of. Out: its texture.

#include <span>

#include "kinloop/core/progress.hpp"
#include "kinloop/dense/image_store.hpp"
#include "kinloop/dense/posed_image.hpp"
#include "kinloop/dense/texture/mesh_texture.hpp"

namespace kinloop {

/// Smallest atlas, pixels.
constexpr int kMinTexturePx = 64;

/// Throws UsageError unless `texture_px` is 0 or a size that texture_mesh takes.
void require_texture_size(int texture_px);

/// Returns a texture of at most `max_size_px` x `max_size_px`, which shows each triangle as the view that
/// sees it best, with levelled seams. Triangles that no view sees have the colours of their vertices.
/// Exposure is compensated by the gains of the views. The result does not depend on `threads`. Throws
/// UsageError if the atlas would be too small for the pieces.
MeshTexture texture_mesh(const ColoredMesh& mesh, const ImageStore& images, std::span<const PosedImage> views,
                         const DenseCamera& camera, int max_size_px, int threads,
                         const Progress& progress = {});

}  // namespace kinloop
