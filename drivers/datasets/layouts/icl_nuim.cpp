// ICL-NUIM (Handa et al. 2014), the "TUM RGB-D compatible PNGs": rgb/, depth/, associations.txt with depth
// first, frame numbers instead of times, and *.gt.freiburg with the poses of these numbers.
//
// The dataset gives fy = -480: its cameras look along z with y up, a left-handed frame. The images are not
// upside down, v = cy - 480 Y/Z. With y down, F = diag(1, -1, 1), the same pixels have fy = +480, and a pose
// becomes F T F, which is right-handed again.

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/camera/camera_presets.hpp"

namespace kinloop {
namespace {

constexpr double kIclRate_hz = 30;

std::string icl_nuim_evidence(const std::filesystem::path& folder, const FolderContents& contents) {
  const bool images = contents.has_folder("rgb") && contents.has_folder("depth");
  if (!images || contents.has_file("rgb.txt")) return {};
  std::string truth = contents.find_file("", ".gt.freiburg");
  if (!truth.empty()) return truth;
  if (contents.has_file("camera.yaml")) return {};  // a folder made for kinloop
  std::string name = folder_name(folder);
  for (const char* part : {"living_room_traj", "office_room_traj", "frei_png"}) {
    if (name.find(part) != std::string::npos) return name;
  }
  return {};
}

/// The time of a frame number, also in the first column of the ground truth.
int64_t stamp_of_number(const std::string& text, const std::filesystem::path& file, size_t line) {
  constexpr double kMaxNumber = 1e7;
  const double number = parse_double(text, file, line);
  if (number < 0 || number > kMaxNumber)
    throw_parse_error(file, line, fmt::format("'{}' is not a frame number", text));
  return to_ns(number / kIclRate_hz);
}

std::vector<RecordedFrame> read_icl_associations(const std::filesystem::path& folder) {
  constexpr size_t kFields = 4;
  const auto file = folder / "associations.txt";
  std::vector<RecordedFrame> frames;
  for (const TextLine& line : read_table(file)) {
    if (line.fields.size() != kFields)
      throw_parse_error(file, line.number, "expected 'number depth_file number colour_file'");
    const int64_t stamp_ns = stamp_of_number(line.fields[0], file, line.number);
    if (!frames.empty() && stamp_ns <= frames.back().stamp_ns)
      throw_parse_error(file, line.number, "frame numbers do not increase; sort the file");
    const bool depth_first = line.fields[1].starts_with("depth");
    const auto depth = folder / line.fields[depth_first ? 1 : 3];
    const auto color = folder / line.fields[depth_first ? 3 : 1];
    frames.push_back({stamp_ns, stamp_ns, {color}, {depth}, {}, 0});
  }
  if (frames.empty()) throw InputError(fmt::format("{}: empty", file.string()));
  return frames;
}

/// F T F: the axis of a rotation is mirrored and the angle turns back.
SE3 mirrored(const SE3& T) {
  const Eigen::Quaterniond& q = T.rotation;
  const Eigen::Vector3d& t = T.translation;
  return {Eigen::Quaterniond(q.w(), -q.x(), q.y(), -q.z()), {t.x(), -t.y(), t.z()}};
}

RecordedSequence read_icl_nuim(const std::filesystem::path& folder) {
  RecordedSequence sequence;
  sequence.layout = "ICL-NUIM folder";
  sequence.camera = camera_preset("icl");
  sequence.stamps_measured = false;
  if (std::filesystem::exists(folder / "associations.txt")) {
    sequence.frames = read_icl_associations(folder);
  } else {
    sequence.frames = pair_by_number(numbered_files(folder / "rgb", "", ".png"),
                                     numbered_files(folder / "depth", "", ".png"), kIclRate_hz);
  }
  const std::string truth = FolderContents(folder).find_file("", ".gt.freiburg");
  if (truth.empty()) return sequence;
  for (const auto& [number_ns, T_world_camera] : read_tum_trajectory(folder / truth)) {
    const int64_t stamp_ns = to_ns(to_seconds(number_ns) / kIclRate_hz);
    sequence.ground_truth.push_back({stamp_ns, mirrored(T_world_camera)});
  }
  return sequence;
}

}  // namespace

SequenceLayout icl_nuim_layout() {
  return {"ICL-NUIM", "rgb/, depth/ and *.gt.freiburg", icl_nuim_evidence, read_icl_nuim};
}

}  // namespace kinloop
