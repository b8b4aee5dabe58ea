#include "drivers/datasets/tum_writer.hpp"

#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/output_file.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"

namespace kinloop {
namespace {

constexpr const char* kWrittenLists[] = {"rgb.txt", "depth.txt", "associations.txt", "groundtruth.txt"};
constexpr const char* kCameraName = "camera.yaml";

std::string color_name(const Frame& frame) {
  return fmt::format("rgb/{}.{}", format_stamp(frame.stamp_ns), frame.color.jpeg().empty() ? "png" : "jpg");
}

std::string depth_name(int64_t stamp_ns) {
  return fmt::format("depth/{}.png", format_stamp(stamp_ns));
}

}  // namespace

std::vector<std::string> tum_file_names() {
  std::vector<std::string> names(std::begin(kWrittenLists), std::end(kWrittenLists));
  names.emplace_back(kCameraName);
  return names;
}

void require_no_sequence(const std::filesystem::path& folder) {
  std::error_code error;
  for (const char* list : kWrittenLists) {
    if (!std::filesystem::exists(folder / list, error)) continue;
    throw InputError(fmt::format("{}: already contains {}; choose another folder, or remove this one first",
                                 folder.string(), list));
  }
  require_writable_folder(folder);
}

TumWriter::TumWriter(std::filesystem::path folder, const RgbdCamera& camera)
    : folder_(std::move(folder)),
      depth_scale_(camera.depth_scale),
      newest_ns_(std::numeric_limits<int64_t>::min()),
      color_list_("# timestamp filename\n"),
      depth_list_(color_list_),
      pair_list_("# colour timestamp, colour filename, depth timestamp, depth filename\n") {
  require_no_sequence(folder_);
  lock_ = std::make_unique<const FolderLock>(folder_);
  for (const char* images : {"rgb", "depth"}) require_writable_folder(folder_ / images);
  write_camera_file(folder_ / kCameraName, camera);
}

void TumWriter::append(const Frame& frame) {
  require(frame.stamp_ns > newest_ns_, "TumWriter: timestamps must increase");
  write_images(frame);
  add_to_lists(frame);
}

void TumWriter::write_images(const Frame& frame) const {
  const std::string_view jpeg = frame.color.jpeg();
  if (jpeg.empty()) {
    write_png(folder_ / color_name(frame), frame.color.bgr());
  } else {
    write_file(folder_ / color_name(frame), jpeg, Durability::kWithTheOthers);
  }
  write_depth_png(folder_ / depth_name(frame.depth_stamp_or_color_ns()), frame.depth_m, depth_scale_);
}

void TumWriter::add_to_lists(const Frame& frame) {
  const int64_t stamp_ns = frame.stamp_ns, depth_stamp_ns = frame.depth_stamp_or_color_ns();
  require(stamp_ns > newest_ns_, "TumWriter: timestamps must increase");
  newest_ns_ = stamp_ns;
  const std::string color = fmt::format("{} {}", format_stamp(stamp_ns), color_name(frame));
  const std::string depth = fmt::format("{} {}", format_stamp(depth_stamp_ns), depth_name(depth_stamp_ns));
  color_list_ += color + "\n";
  depth_list_ += depth + "\n";
  pair_list_ += fmt::format("{} {}\n", color, depth);
}

void TumWriter::finish(const Trajectory& ground_truth) {
  flush_files(folder_);
  if (!ground_truth.empty()) write_tum_trajectory(folder_ / "groundtruth.txt", ground_truth);
  write_file(folder_ / "associations.txt", pair_list_);
  write_file(folder_ / "depth.txt", depth_list_);
  write_file(folder_ / "rgb.txt", color_list_);
}

}  // namespace kinloop
