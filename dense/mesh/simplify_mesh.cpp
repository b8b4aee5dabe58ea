// The only file that includes CGAL, which is slow to compile.

#include "dense/mesh/simplify_mesh.hpp"

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_CGAL

#include <algorithm>
#include <cstdint>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#pragma GCC diagnostic pop

namespace kinloop {
namespace {

namespace processing = CGAL::Polygon_mesh_processing;
namespace simplification = CGAL::Surface_mesh_simplification;

using CgalPoint = CGAL::Simple_cartesian<double>::Point_3;
using CgalMesh = CGAL::Surface_mesh<CgalPoint>;
using Soup = std::vector<std::vector<size_t>>;  // corners of each triangle

/// Ends the simplification. CGAL has the same from version 5.6 on.
struct FewTriangles {
  size_t max_triangles;

  template <class Cost, class Profile>
  bool operator()(const Cost&, const Profile& profile, size_t, size_t) const {
    return profile.surface_mesh().number_of_faces() <= max_triangles;
  }
};

CgalMesh manifold_surface(const ColoredMesh& mesh, size_t min_component_triangles) {
  std::vector<CgalPoint> points;
  Soup triangles;
  for (const Eigen::Vector3f& p : mesh.points) points.emplace_back(p.x(), p.y(), p.z());
  for (const auto& [a, b, c] : mesh.triangles) triangles.push_back({a, b, c});
  processing::repair_polygon_soup(points, triangles);
  processing::orient_polygon_soup(points, triangles);
  CgalMesh surface;
  processing::polygon_soup_to_polygon_mesh(points, triangles, surface);
  // An edge of four triangles has been cut open. Where the surfaces that meet in it are one at its end, a
  // slit is left, which has no area, but which no collapse of edges can close.
  processing::stitch_borders(surface);
  processing::keep_large_connected_components(surface, min_component_triangles);
  surface.collect_garbage();  // numbers the vertices that are left from 0
  return surface;
}

ColoredMesh mesh_of(const CgalMesh& surface) {
  ColoredMesh mesh;
  for (const auto vertex : surface.vertices()) {
    const CgalPoint& p = surface.point(vertex);
    mesh.points.push_back(Eigen::Vector3d(p.x(), p.y(), p.z()).cast<float>());
  }
  mesh.colors.resize(mesh.points.size());
  for (const auto face : surface.faces()) {
    const auto corners = surface.vertices_around_face(surface.halfedge(face));
    Triangle& triangle = mesh.triangles.emplace_back();
    std::transform(corners.begin(), corners.end(), triangle.begin(),
                   [](auto vertex) { return static_cast<uint32_t>(vertex.idx()); });
  }
  return mesh;
}

}  // namespace

bool mesh_simplification_available() {
  return true;
}

ColoredMesh manifold_mesh(const ColoredMesh& mesh, size_t min_component_triangles) {
  return mesh_of(manifold_surface(mesh, min_component_triangles));
}

ColoredMesh simplified_mesh(const ColoredMesh& mesh, size_t max_triangles, size_t min_component_triangles) {
  CgalMesh surface = manifold_surface(mesh, min_component_triangles);
  // A collapse that turns a triangle over would fold the surface; without this, many such follow where the
  // topology allows few others.
  using Placement =
      simplification::Bounded_normal_change_placement<simplification::LindstromTurk_placement<CgalMesh>>;
  simplification::edge_collapse(surface, FewTriangles{max_triangles},
                                CGAL::parameters::get_placement(Placement()));
  surface.collect_garbage();
  return mesh_of(surface);
}

}  // namespace kinloop

#else

namespace kinloop {

bool mesh_simplification_available() {
  return false;
}

ColoredMesh manifold_mesh(const ColoredMesh&, size_t) {
  require_mesh_simplification();
  return {};
}

ColoredMesh simplified_mesh(const ColoredMesh&, size_t, size_t) {
  require_mesh_simplification();
  return {};
}

}  // namespace kinloop

#endif

namespace kinloop {

void require_mesh_simplification() {
  if (!mesh_simplification_available())
    throw UsageError(
        "mesh.triangles, mesh.manifold: this build has no CGAL; install libcgal-dev and rebuild kinloop");
}

}  // namespace kinloop
