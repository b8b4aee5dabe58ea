#include "tests/fuzz/targets/expectations.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/core/files/byte_reader.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop::fuzz {
namespace {

void expect_possible_lens(const PinholeCamera& lens) {
  require(lens.width > 0 && lens.height > 0, "a camera without pixels");
  require(lens.fx > 0 && lens.fy > 0, "a focal length that is not positive");
  const LensDistortion& d = lens.lens;
  for (const double value :
       {lens.fx, lens.fy, lens.cx, lens.cy, d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6})
    require(std::isfinite(value), "a camera that is not finite");
}

void expect_possible_frame(const Frame& frame, const PinholeCamera& camera) {
  const cv::Size size(camera.width, camera.height);
  require(frame.color.size() == size && frame.depth_m.size() == size,
          "images of another size than the camera's");
  require(frame.depth_m.type() == CV_32FC1 && frame.color.gray().type() == CV_8UC1, "images of another type");
  for (int y = 0; y < frame.depth_m.rows; ++y) {
    const auto* row = frame.depth_m.ptr<float>(y);
    require(std::all_of(row, row + frame.depth_m.cols, [](float z) { return z >= 0 && std::isfinite(z); }),
            "depth that is negative or not finite");
  }
}

/// Names that leave the folder, and those that no file can have, are left out.
bool is_possible_name(const std::filesystem::path& name) {
  constexpr size_t kMaxLength = 100;
  const std::string text = name.string();
  return !text.empty() && text.size() < kMaxLength && printable(text) == text && name.is_relative() &&
         std::find(name.begin(), name.end(), "..") == name.end() && name.has_filename();
}

}  // namespace

void expect_possible(const RgbdCamera& camera) {
  expect_possible_lens(camera.color);
  if (camera.depth) expect_possible_lens(*camera.depth);
  require(camera.depth_scale > 0 && std::isfinite(camera.depth_scale),
          "a unit of depth that is not possible");
  require(camera.T_color_depth.is_finite(), "a pose that is not finite");
  require(std::isfinite(camera.fps) && std::isfinite(camera.depth_shift_m), "a camera that is not finite");
}

void read_frames(FrameSource& source) {
  constexpr int kMaxFrames = 8;
  expect_possible(source.camera());
  for (int i = 0; i < kMaxFrames; ++i) {
    const auto frame = source.next();
    if (!frame) break;
    expect_possible_frame(*frame, source.camera().color);
  }
  static_cast<void>(source.skipped());
}

void with_file(const std::string& name, std::string_view bytes,
               const std::function<void(const std::filesystem::path&)>& read) {
  const test::TempFolder folder;
  read(folder.write(name, bytes));
}

void with_folder(std::string_view archive, const std::function<void(const std::filesystem::path&)>& read) {
  constexpr std::string_view kBegin = "-- ", kEnd = " --\n";
  constexpr int kMaxFiles = 64;
  const test::TempFolder folder;
  size_t at = archive.find(kBegin);
  for (int i = 0; i < kMaxFiles && at != std::string_view::npos; ++i) {
    const size_t name_begin = at + kBegin.size(), name_end = archive.find(kEnd, name_begin);
    if (name_end == std::string_view::npos) break;
    const size_t begin = name_end + kEnd.size(), next = archive.find("\n-- ", begin - 1);
    const auto content = next == std::string_view::npos || next < begin ? archive.substr(begin)
                                                                        : archive.substr(begin, next - begin);
    const std::filesystem::path name(archive.substr(name_begin, name_end - name_begin));
    try {
      if (is_possible_name(name)) folder.write(name, next < begin ? std::string_view() : content);
    } catch (const std::filesystem::filesystem_error&) {
      // A name that is both a file and a folder.
    }
    at = next == std::string_view::npos ? next : next + 1;
  }
  read(folder.path());
}

}  // namespace kinloop::fuzz
