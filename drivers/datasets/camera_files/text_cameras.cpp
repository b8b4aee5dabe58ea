// Plain text: matrices of intrinsics, a few numbers in a known order, and COLMAP's cameras.txt.

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {
namespace {

constexpr size_t kMostCameraNumbers = 64;

/// The lines with their words; brackets, commas and semicolons separate, as NumPy and MATLAB print matrices.
std::vector<TextLine> camera_lines(const CameraDocument& document) {
  std::istringstream content(document.text());
  std::vector<TextLine> lines;
  std::string text;
  for (size_t number = 1; std::getline(content, text); ++number) {
    if (const size_t first = text.find_first_not_of(" \t\r"); first == std::string::npos ||
                                                              text[first] == '#' || text[first] == '%' ||
                                                              text.compare(first, 2, "//") == 0)
      continue;
    for (char& c : text) {
      if (std::string_view("[](),;").find(c) != std::string_view::npos) c = ' ';
    }
    std::istringstream words(text);
    TextLine line{number, {}};
    for (std::string word; words >> word;) line.fields.push_back(word);
    if (!line.fields.empty()) lines.push_back(std::move(line));
    if (lines.size() > kMostCameraNumbers) break;
  }
  return lines;
}

/// All numbers of a file that begins with one; empty for any other file.
std::vector<double> camera_numbers(const CameraDocument& document) {
  constexpr size_t kLongestNumber = 64;
  std::vector<double> numbers;
  for (const TextLine& line : camera_lines(document)) {
    for (const std::string& word : line.fields) {
      if (word.size() > kLongestNumber) return {};
      const bool number_begins =
          word.find_first_not_of("0123456789+-.eE") == std::string::npos || word == "nan" || word == "inf";
      if (numbers.empty() && !number_begins) return {};
      numbers.push_back(parse_double(word, document.file(), line.number));
      if (numbers.size() > kMostCameraNumbers) return {};
    }
  }
  return numbers;
}

bool is_size(double width, double height) {
  constexpr double kLeast_px = 16;
  return width >= kLeast_px && height >= kLeast_px && width == std::floor(width) &&
         height == std::floor(height);
}

bool is_distortion_count(size_t count) {
  return count == 4 || count == 5 || count == 8;
}

}  // namespace

std::optional<CameraDescription> read_matrix_numbers(const CameraDocument& document) {
  const auto numbers = camera_numbers(document);
  // Some files have the distortion after a 3x3 matrix; 9 numbers and more may also begin a larger matrix.
  for (const size_t count : {size_t{16}, size_t{12}, size_t{9}}) {
    if (numbers.size() < count) continue;
    const std::span matrix = std::span(numbers).first(count), rest = std::span(numbers).subspan(count);
    const auto k = intrinsics_of_matrix(matrix);
    const bool size = rest.size() == 2 && is_size(rest[0], rest[1]);
    if (!k || !(rest.empty() || size || is_distortion_count(rest.size()))) continue;
    CameraDescription description = description_of(document);
    set_intrinsics(description, k->fx, k->fy, k->cx, k->cy);
    if (size) set_size(description, rest[0], rest[1]);
    if (!size) set_distortion(description, rest);
    return description;
  }
  return std::nullopt;
}

std::optional<CameraDescription> read_number_list(const CameraDocument& document) {
  constexpr size_t kIntrinsics = 4, kSize = 2;
  std::vector<double> n = camera_numbers(document);
  const bool has_size = n.size() == kIntrinsics + kSize ||
                        (n.size() > kIntrinsics + kSize &&
                         is_distortion_count(n.size() - kIntrinsics - kSize) && is_size(n[4], n[5]));
  if (!has_size && n.size() != kIntrinsics &&
      !(n.size() > kIntrinsics && is_distortion_count(n.size() - kIntrinsics)))
    return std::nullopt;
  if (has_size && !is_size(n[4], n[5])) {
    if (!is_size(n[0], n[1])) return std::nullopt;
    std::rotate(n.begin(), n.begin() + kSize, n.begin() + kIntrinsics + kSize);  // the size comes first
  }
  CameraDescription description = description_of(document);
  set_intrinsics(description, n[0], n[1], n[2], n[3]);
  if (has_size) set_size(description, n[4], n[5]);
  set_distortion(description, std::span(n).subspan(kIntrinsics + (has_size ? kSize : 0)));
  return description;
}

namespace {

/// A camera model of COLMAP: how many focal lengths it has, and how many distortion coefficients.
struct ColmapModel {
  const char* name;
  size_t focal_lengths, coefficients;
  DistortionModel distortion;
};

constexpr std::array kColmapModels = {
    ColmapModel{"SIMPLE_PINHOLE", 1, 0, DistortionModel::kOpenCv},
    ColmapModel{"PINHOLE", 2, 0, DistortionModel::kOpenCv},
    ColmapModel{"SIMPLE_RADIAL", 1, 1, DistortionModel::kOpenCv},
    ColmapModel{"RADIAL", 1, 2, DistortionModel::kOpenCv},
    ColmapModel{"OPENCV", 2, 4, DistortionModel::kOpenCv},
    ColmapModel{"FULL_OPENCV", 2, 8, DistortionModel::kOpenCv},
    ColmapModel{"OPENCV_FISHEYE", 2, 4, DistortionModel::kFisheye},
};

constexpr size_t kColmapModelField = 1;

/// Null for a model that kinloop does not have.
const ColmapModel* find_colmap_model(const std::string& name) {
  const auto* model = std::find_if(kColmapModels.begin(), kColmapModels.end(),
                                   [&](const ColmapModel& m) { return name == m.name; });
  return model == kColmapModels.end() ? nullptr : model;
}

bool is_colmap_line(const TextLine& line) {
  static constexpr std::array<std::string_view, 6> kOthers = {
      "SIMPLE_RADIAL_FISHEYE",     "RADIAL_FISHEYE", "FOV", "THIN_PRISM_FISHEYE", "SIMPLE_FISHEYE",
      "RAD_TAN_THIN_PRISM_FISHEYE"};  // which kinloop does not have
  if (line.fields.size() <= kColmapModelField) return false;
  if (line.fields[0].find_first_not_of("0123456789") != std::string::npos)
    return false;  // the number of a camera
  const std::string& name = line.fields[kColmapModelField];
  return find_colmap_model(name) != nullptr ||
         std::find(kOthers.begin(), kOthers.end(), name) != kOthers.end();
}

/// The centre of COLMAP's top left pixel is (0.5, 0.5).
CameraDescription read_colmap_line(const CameraDocument& document, const TextLine& line) {
  constexpr size_t kParameters = 4;
  constexpr double kPixelCentre = 0.5;
  const std::string& name = line.fields[kColmapModelField];
  const ColmapModel* model = find_colmap_model(name);
  if (model == nullptr)
    throw_parse_error(
        document.file(), line.number,
        fmt::format("the camera model {}, which kinloop does not have; undistort the images in COLMAP",
                    name));
  const size_t expected = kParameters + model->focal_lengths + 2 + model->coefficients;
  if (line.fields.size() != expected)
    throw_parse_error(
        document.file(), line.number,
        fmt::format("{} fields where a camera {} has {}; copy it again", line.fields.size(), name, expected));
  std::vector<double> numbers;
  for (size_t i = 2; i < line.fields.size(); ++i)
    numbers.push_back(parse_double(line.fields[i], document.file(), line.number));
  const std::span p = std::span(numbers).subspan(2);
  const size_t f = model->focal_lengths;
  CameraDescription description = description_of(document);
  set_size(description, numbers[0], numbers[1]);
  set_intrinsics(description, p[0], p[f - 1], p[f] - kPixelCentre, p[f + 1] - kPixelCentre);
  set_distortion(description, p.subspan(f + 2), model->distortion);
  return description;
}

}  // namespace

std::optional<CameraDescription> read_colmap(const CameraDocument& document) {
  const auto lines = camera_lines(document);
  if (lines.empty() || !is_colmap_line(lines.front())) return std::nullopt;
  const CameraDescription first = read_colmap_line(document, lines.front());
  for (const TextLine& line : lines) {
    if (!is_colmap_line(line) || !agree(read_colmap_line(document, line), first))
      throw_parse_error(document.file(), line.number,
                        "another camera than the first; keep only the line of the colour camera");
  }
  return first;
}

}  // namespace kinloop
