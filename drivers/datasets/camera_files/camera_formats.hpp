#pragma once
// The formats of camera files that kinloop reads: each family a file with a function here, listed in the
// table. A format is recognised by its content, not by its name.

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "drivers/datasets/camera_files/camera_description.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {

// In: a text file. Out: its values if it is JSON or YAML, in one form for both, so that a format is a table
// of keys. Errors name the line of a key.

class CameraDocument {
 public:
  /// Reads a file. Throws InputError naming the file, and the line if it is damaged, for one that is too
  /// large, binary or UTF-16, or that has the ending of JSON or YAML and is something else. XML is an object
  /// of its elements.
  static CameraDocument read(const std::filesystem::path& file);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const std::string& text() const { return text_; }

  /// An object; null for plain text.
  [[nodiscard]] const nlohmann::json& values() const { return values_; }

  /// Throws InputError naming the file and the first line with `key`.
  [[noreturn]] void reject(std::string_view key, const std::string& what) const;

  /// Values that a reader of a format has asked for.
  void forget_used() const { used_.clear(); }
  void note_used(const nlohmann::json& value) const { used_.insert(&value); }
  [[nodiscard]] bool is_used(const nlohmann::json& value) const { return used_.contains(&value); }

 private:
  std::filesystem::path file_;
  std::string text_;  ///< without a byte-order mark
  nlohmann::json values_;
  mutable std::set<const nlohmann::json*> used_;
};

/// A file that is that of a camera, with a part that is not understood and would change the result.
class CameraPartError : public InputError {
 public:
  using InputError::InputError;
};

/// Throws CameraPartError naming the first key of an object, or of those in it, that looks like distortion,
/// extrinsics of depth, a unit of depth or a size of images, states something and was not asked for.
void require_understood(const CameraDocument& document, const nlohmann::json& object);

/// An object in a document. A key "a.b" is that key, or b in the object a: ORB-SLAM writes the one,
/// stella_vslam the other.
class CameraValues {
 public:
  explicit CameraValues(const CameraDocument& document) : CameraValues(document, document.values()) {}
  CameraValues(const CameraDocument& document, const nlohmann::json& object, std::string name = {})
      : document_(&document), object_(&object), name_(std::move(name)) {}

  /// The key of this object; empty for the whole document.
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Returns the value of the first of the keys that is there; null if there is none.
  [[nodiscard]] const nlohmann::json* find(std::initializer_list<std::string_view> keys) const;
  [[nodiscard]] bool has(std::string_view key) const { return find({key}) != nullptr; }

  /// Returns whether the first of the keys that is there has a list, or a matrix with `data`.
  [[nodiscard]] bool has_list(std::initializer_list<std::string_view> keys) const;

  /// Returns the objects in this one, this one first, with their own objects, in order of their keys.
  [[nodiscard]] std::vector<CameraValues> with_objects_below() const;

  /// Returns the number of the first key that is there; nullopt if there is none. Throws InputError naming
  /// the line if its value is not a finite number.
  [[nodiscard]] std::optional<double> number(std::initializer_list<std::string_view> keys) const;

  /// Same; throws InputError if there is none.
  [[nodiscard]] double required(std::initializer_list<std::string_view> keys) const;

  /// Returns the numbers of a list, of a list of lists, or of a matrix with `data`; empty if there is none of
  /// the keys. Throws InputError naming the line if it is something else.
  [[nodiscard]] std::vector<double> numbers(std::initializer_list<std::string_view> keys) const;

  /// Returns the text in small letters; empty if there is none.
  [[nodiscard]] std::string word(std::initializer_list<std::string_view> keys) const;

  /// Returns the object of the first of the keys that is there; nullopt if there is none.
  [[nodiscard]] std::optional<CameraValues> object_at(std::initializer_list<std::string_view> keys) const;

  [[nodiscard]] const CameraDocument& document() const { return *document_; }
  [[nodiscard]] const nlohmann::json& object() const { return *object_; }

 private:
  [[nodiscard]] const nlohmann::json* find_one(std::string_view key) const;

  const CameraDocument* document_;
  const nlohmann::json* object_;
  std::string name_;
};

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
/// Camera files of camodocal, which VINS and its relatives use: PINHOLE and KANNALA_BRANDT.
std::optional<CameraDescription> read_camodocal(const CameraDocument& document);
/// calibration.json of Basalt; its first camera.
std::optional<CameraDescription> read_basalt(const CameraDocument& document);
/// JSON of MATLAB's cameraParameters or cameraIntrinsics.
std::optional<CameraDescription> read_matlab(const CameraDocument& document);
/// XML of Agisoft Metashape.
std::optional<CameraDescription> read_agisoft(const CameraDocument& document);
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

/// Parses XML as far as camera files use it: elements become objects, numbers or lists of numbers, or texts;
/// attributes are left out. nullopt if it is damaged or nested more than 16 deep.
std::optional<nlohmann::json> parse_camera_xml(std::string_view text);

/// Starts the description of a document.
CameraDescription description_of(const CameraDocument& document);

}  // namespace kinloop
