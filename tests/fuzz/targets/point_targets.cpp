#include "dense/files/ply.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"
#include "viewer/point_files/point_file.hpp"

namespace kinloop::fuzz {
namespace {

void expect_possible_mesh(const ColoredMesh& mesh) {
  require(mesh.colors.empty() || mesh.colors.size() == mesh.points.size(), "not a colour for each point");
  for (const auto& point : mesh.points) require(point.allFinite(), "a point that is not finite");
  for (const auto& triangle : mesh.triangles) {
    for (const uint32_t corner : triangle) require(corner < mesh.points.size(), "a corner without a point");
  }
}

}  // namespace

void read_ply_bytes(std::string_view bytes) {
  with_file("a.ply", bytes, [](const auto& path) {
    accept([&] { expect_possible_mesh(read_any_ply(path).mesh); });
    accept([&] { static_cast<void>(read_ply(path)); });
    accept([&] { static_cast<void>(read_ply_frame(path)); });
  });
}

void read_glb_bytes(std::string_view bytes) {
  with_file("a.glb", bytes, [](const auto& path) { accept([&] { static_cast<void>(read_glb(path)); }); });
}

void read_pcd_bytes(std::string_view bytes) {
  with_file("a.pcd", bytes,
            [](const auto& path) { accept([&] { expect_possible_mesh(read_any_pcd(path).mesh); }); });
}

}  // namespace kinloop::fuzz
