// Folders that ScanNet's SensReader writes: BundleFusion (Dai et al. 2017), 3RScan. frame-000000.color.jpg,
// .depth.png or .depth.pgm (16 bits, big-endian), .pose.txt, and info.txt with both cameras:
//   m_colorWidth = 640
//   m_calibrationColorIntrinsic = 583 0 320 0 0 583 240 0 0 0 1 0 0 0 0 1
//   m_depthShift = 1000

#include <map>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/lists/frame_files.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "drivers/datasets/reading/two_lenses.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

std::string bundle_fusion_evidence(const fs::path&, const FolderContents& contents) {
  if (frame_files_evidence(contents).empty()) return {};
  for (const char* name : {"info.txt", "_info.txt"}) {
    if (contents.has_file(name)) return name;
  }
  return {};
}

/// "key = value value ..." lines.
class InfoFile {
 public:
  explicit InfoFile(fs::path file) : file_(std::move(file)) {
    for (TextLine& line : read_table(file_)) {
      const bool assigns = line.fields.size() >= 3 && line.fields[1] == "=";
      if (assigns) lines_.emplace(line.fields[0], line);
    }
  }

  [[nodiscard]] std::vector<double> numbers(const std::string& key, size_t count) const {
    const auto found = lines_.find(key);
    if (found == lines_.end() || found->second.fields.size() < count + 2)
      throw InputError(
          fmt::format("{}: no '{} = ...' with {} numbers; copy it again", file_.string(), key, count));
    std::vector<double> values;
    for (size_t i = 0; i < count; ++i)
      values.push_back(parse_double(found->second.fields[i + 2], file_, found->second.number));
    return values;
  }

  [[nodiscard]] PinholeCamera lens(const std::string& name) const {
    constexpr double kMax_px = 30'000;
    const double width = numbers("m_" + name + "Width", 1)[0];
    const double height = numbers("m_" + name + "Height", 1)[0];
    if (!(width >= 1 && width <= kMax_px && height >= 1 && height <= kMax_px))
      throw InputError(fmt::format("{}: {} images of {} x {}", file_.string(), name, width, height));
    const std::string camera = name == "color" ? "Color" : "Depth";
    const auto k = numbers("m_calibration" + camera + "Intrinsic", 16);
    const cv::Size size(static_cast<int>(width), static_cast<int>(height));
    return checked_lens(make_lens(size, k[0], k[5], k[2], k[6]), file_);
  }

  [[nodiscard]] SE3 extrinsic(const std::string& key) const {
    if (lines_.count(key) == 0) return {};
    return rigid_motion(*matrix_of(numbers(key, 16))).value_or(SE3{});
  }

 private:
  fs::path file_;
  std::map<std::string, TextLine> lines_;
};

RecordedSequence read_bundle_fusion(const fs::path& folder) {
  const InfoFile info(folder / bundle_fusion_evidence(folder, FolderContents(folder)));
  RecordedSequence sequence = read_frame_files(folder);
  sequence.layout = "BundleFusion folder";
  const TwoLenses lenses{info.lens("color"), info.lens("depth"),
                         info.extrinsic("m_calibrationColorExtrinsic"),
                         info.extrinsic("m_calibrationDepthExtrinsic")};
  const double depth_shift = info.numbers("m_depthShift", 1)[0];
  sequence.camera = camera_of(lenses, depth_shift, folder);
  sequence.sensor = DepthSensorModel::kStructuredLight;  // a Structure Sensor
  move_to_color(lenses, sequence.ground_truth);
  return sequence;
}

}  // namespace

SequenceLayout bundle_fusion_layout() {
  return {"BundleFusion", "frame-000000.color.jpg, frame-000000.depth.png and info.txt",
          bundle_fusion_evidence, read_bundle_fusion};
}

}  // namespace kinloop
