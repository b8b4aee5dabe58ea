#pragma once
// In: a coloured mesh, and the posed images that it was made of. Out: its texture.

#include <optional>
#include <span>

#include "dense/image_store.hpp"
#include "dense/options.hpp"
#include "dense/posed_image.hpp"
#include "dense/texture/mesh_texture.hpp"
#include "kinloop/core/progress.hpp"

namespace kinloop {

/// Smallest atlas, pixels.
constexpr int kMinTexturePx = 64;

/// Returns a texture of at most `max_size_px` x `max_size_px`, which shows each triangle as the view that
/// sees it best, with levelled seams. Triangles that no view sees have the colours of their vertices.
/// Exposure is compensated by the gains of the views. The result does not depend on `threads`. Throws
/// UsageError if the atlas would be too small for the pieces.
MeshTexture texture_mesh(const ColoredMesh& mesh, const StoredViews& stored, int max_size_px, int threads,
                         const Progress& progress = {});

/// A mesh with a texture, if it has one.
struct TexturedMesh {
  ColoredMesh mesh;
  std::optional<MeshTexture> texture;
};

/// Returns the mesh of reconstruct_mesh, with a texture if `options.texture_px` is not 0. Throws UsageError
/// if that size is too small, and as both functions.
TexturedMesh reconstruct_textured_mesh(const StoredViews& stored, const MeshOptions& options, int threads,
                                       const Progress& progress = {});

}  // namespace kinloop
