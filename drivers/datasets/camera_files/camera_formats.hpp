#pragma once
// The formats of camera files that kinloop reads: each family a file with a function here, listed in the
// table. A format is recognised by its content, not by its name.

#include <filesystem>
#include <optional>
#include <span>

#include "drivers/datasets/camera_files/camera_description.hpp"
#include "drivers/datasets/camera_files/camera_document.hpp"

namespace kinloop {

struct CameraFormat {
  const char* name;  ///< for users

  /// Returns what the file states; nullopt if it is in another format. Throws InputError naming the file, and
  /// the line if there is one, if it is in this format and damaged.
  std::optional<CameraDescription> (*read)(const CameraDocument& document);
};

/// All formats; those that are recognised by more come first.
std::span<const CameraFormat> camera_formats();

/// Reads a camera file in any format; nullopt if it is in none of them. Throws InputError naming the file and
/// the remedy if it is damaged.
std::optional<CameraDescription> find_description(const std::filesystem::path& file);

/// Same; throws InputError if the file is in no known format.
CameraDescription read_camera_description(const std::filesystem::path& file);

/// camera.yaml.
std::optional<CameraDescription> read_own_camera(const CameraDocument& document);
/// Settings of ORB-SLAM2, ORB-SLAM3 and stella_vslam.
std::optional<CameraDescription> read_slam_settings(const CameraDocument& document);
/// camchain.yaml of Kalibr; its first camera.
std::optional<CameraDescription> read_kalibr(const CameraDocument& document);
/// transforms.json of Nerfstudio and instant-ngp.
std::optional<CameraDescription> read_transforms(const CameraDocument& document);
/// OpenCV's FileStorage, ROS's camera_info and others with a matrix of intrinsics, such as Open3D's.
std::optional<CameraDescription> read_matrix_values(const CameraDocument& document);
/// JSON or YAML with fx, fy, cx, cy.
std::optional<CameraDescription> read_focal_lengths(const CameraDocument& document);
/// cameras.txt of COLMAP.
std::optional<CameraDescription> read_colmap(const CameraDocument& document);
/// A matrix of 3x3, 3x4 or 4x4 numbers.
std::optional<CameraDescription> read_matrix_numbers(const CameraDocument& document);
/// fx fy cx cy, and perhaps the size of the images.
std::optional<CameraDescription> read_number_list(const CameraDocument& document);

/// fx, fy, cx, cy of a matrix of 9, 12 or 16 numbers in row or, as Open3D and MATLAB have it, column order;
/// nullopt if it is no matrix of intrinsics.
struct MatrixIntrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;
};
std::optional<MatrixIntrinsics> intrinsics_of_matrix(std::span<const double> numbers);

/// Starts the description of a document.
CameraDescription description_of(const CameraDocument& document);

}  // namespace kinloop
