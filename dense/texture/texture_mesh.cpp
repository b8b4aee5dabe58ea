#include "dense/texture/texture_mesh.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "dense/mesh/reconstruct_mesh.hpp"
#include "dense/texture/atlas/paint_atlas.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {

MeshTexture texture_mesh(const ColoredMesh& mesh, const StoredViews& stored, int max_size_px, int threads,
                         const Progress& progress) {
  require(max_size_px >= kMinTexturePx, "texture_mesh: the texture is too small");
  require(mesh.points.size() == mesh.colors.size(), "texture_mesh: expected one colour per vertex");
  const ViewCandidates candidates = find_view_candidates(mesh, stored, threads, progress);
  const std::vector<uint32_t> chosen = choose_views(mesh, candidates);
  AtlasLayout layout = lay_out_atlas(mesh, chosen, stored.views, stored.camera.color, max_size_px);
  const VertexViews vertex_views = level_seams(mesh, chosen, candidates);

  MeshTexture texture;
  texture.image = paint_atlas({mesh, layout, chosen, candidates, vertex_views}, stored, threads, progress);
  const Eigen::Array2f size(static_cast<float>(layout.size.width), static_cast<float>(layout.size.height));
  for (const Eigen::Vector2f& px : layout.corners_px) texture.uvs.emplace_back((px.array() + 0.5F) / size);
  texture.vertex_of_uv = std::move(layout.vertex_of_corner);
  texture.triangles = std::move(layout.triangles);
  texture.unseen_triangles = static_cast<size_t>(std::count(chosen.begin(), chosen.end(), kNoView));
  texture.charts = layout.charts.size() - texture.unseen_triangles;
  texture.scale = layout.scale;
  return texture;
}

TexturedMesh reconstruct_textured_mesh(const StoredViews& stored, const MeshOptions& options, int threads,
                                       const Progress& progress) {
  const int size_px = options.texture_px;
  if (size_px != 0 && size_px < kMinTexturePx)
    throw UsageError(
        fmt::format("mesh.texture_px is {}; expected 0 (no texture) or at least {}", size_px, kMinTexturePx));
  TexturedMesh made{reconstruct_mesh(stored, options, threads, progress), {}};
  if (size_px > 0) made.texture = texture_mesh(made.mesh, stored, size_px, threads, progress);
  return made;
}

}  // namespace kinloop
