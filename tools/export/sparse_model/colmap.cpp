#include <fmt/format.h>

#include "kinloop/core/files/text_file.hpp"
#include "tools/export/sparse_model/sparse_model.hpp"

namespace kinloop {
namespace {

std::string cameras_text(const PinholeCamera& camera) {
  return fmt::format("# CAMERA_ID MODEL WIDTH HEIGHT fx fy cx cy\n1 PINHOLE {} {} {} {} {} {}\n",
                     camera.width, camera.height, camera.fx, camera.fy, camera.cx + kPixelCenter,
                     camera.cy + kPixelCenter);
}

std::string images_text(const SparseModel& model) {
  std::string text =
      "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME (from the world to the camera)\n"
      "# POINTS2D as X Y POINT3D_ID\n";
  size_t id = 0;
  for (const ModelImage& image : model.images) {
    const SE3 T = image.T_file_camera.inverse();
    const Eigen::Quaterniond& q = T.rotation;
    const Eigen::Vector3d& t = T.translation;
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {} {} {} 1 {}.jpg\n", ++id, q.w(), q.x(), q.y(),
                   q.z(), t.x(), t.y(), t.z(), image.name);
    const char* space = "";
    for (const auto& [pixel, point] : image.observations) {
      fmt::format_to(std::back_inserter(text), "{}{:.3f} {:.3f} {}", space, pixel.x() + kPixelCenter,
                     pixel.y() + kPixelCenter, point + 1);
      space = " ";
    }
    text += '\n';
  }
  return text;
}

std::string points_text(const SparseModel& model) {
  std::string text = "# POINT3D_ID X Y Z R G B ERROR TRACK as IMAGE_ID POINT2D_IDX\n";
  size_t id = 0;
  for (const ModelPoint& point : model.points) {
    const Eigen::Vector3d& p = point.p_file;
    fmt::format_to(std::back_inserter(text), "{} {:.6f} {:.6f} {:.6f} {} {} {} {:.4f}", ++id, p.x(), p.y(),
                   p.z(), point.color[0], point.color[1], point.color[2], point.error_px);
    for (const auto& [image, observation] : point.track)
      fmt::format_to(std::back_inserter(text), " {} {}", image + 1, observation);
    text += '\n';
  }
  return text;
}

}  // namespace

void write_colmap_model(const std::filesystem::path& folder, const SparseModel& model) {
  const auto sparse = folder / "sparse" / "0";
  make_folder(sparse);
  write_file(sparse / "cameras.txt", cameras_text(model.camera));
  write_file(sparse / "points3D.txt", points_text(model));
  write_file(sparse / "images.txt", images_text(model));
}

}  // namespace kinloop
