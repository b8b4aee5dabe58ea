#include <nlohmann/json.hpp>

#include "dense/files/ply.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/json.hpp"
#include "tools/export/sparse_model/sparse_model.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

constexpr const char* kPointsName = "sparse_pc.ply";

/// The pose of a camera with OpenGL's axes, by rows.
json transform_matrix(const SE3& T_file_camera) {
  Eigen::Matrix4d T = T_file_camera.matrix();
  T.middleCols<2>(1) *= -1;  // y and z of the camera are reversed
  json rows = json::array();
  for (int row = 0; row < 4; ++row) rows.push_back({T(row, 0), T(row, 1), T(row, 2), T(row, 3)});
  return rows;
}

/// The points, in the world frame as the writers of clouds expect.
ColoredCloud cloud_of(const SparseModel& model) {
  const Eigen::Quaterniond R_world_file = model.frame.T_file_world().rotation.conjugate();
  ColoredCloud cloud;
  for (const ModelPoint& point : model.points) {
    cloud.points.emplace_back((R_world_file * point.p_file).cast<float>());
    cloud.colors.push_back(point.color);
  }
  return cloud;
}

}  // namespace

void write_nerfstudio(const std::filesystem::path& folder, const SparseModel& model) {
  const PinholeCamera& camera = model.camera;
  json scene = {{"camera_model", "OPENCV"},
                {"w", camera.width},
                {"h", camera.height},
                {"fl_x", camera.fx},
                {"fl_y", camera.fy},
                {"cx", camera.cx + kPixelCenter},
                {"cy", camera.cy + kPixelCenter},
                {"ply_file_path", kPointsName},
                {"frames", json::array()}};
  for (const char* coefficient : {"k1", "k2", "p1", "p2"}) scene[coefficient] = 0.0;
  for (const ModelImage& image : model.images) {
    scene["frames"].push_back({{"file_path", "images/" + image.name + ".jpg"},
                               {"depth_file_path", "depth/" + image.name + ".png"},
                               {"stamp_ns", image.stamp_ns},
                               {"transform_matrix", transform_matrix(image.T_file_camera)}});
  }
  make_folder(folder);
  write_ply(folder / kPointsName, cloud_of(model), model.frame);
  write_file(folder / "transforms.json", json_text(scene, 1) + "\n");
}

}  // namespace kinloop
