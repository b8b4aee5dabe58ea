#include "drivers/datasets/reading/lists/frame_files.hpp"

#include <array>

#include <fmt/format.h>

#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

constexpr std::array kColorEndings = {".color.png", ".color.jpg"};
constexpr std::array kDepthEndings = {".depth.png", ".depth.pgm"};

template <size_t kCount>
std::vector<NumberedFile> first_listed(const std::filesystem::path& folder,
                                       const std::array<const char*, kCount>& endings) {
  for (const char* ending : endings) {
    auto files = numbered_files(folder, "frame-", ending);
    if (!files.empty()) return files;
  }
  throw InputError(fmt::format("{}: no frame-000000{} or {}; copy the images of the whole sequence",
                               folder.string(), endings[0], endings[1]));
}

std::filesystem::path pose_file_of(const RecordedFrame& frame) {
  const std::string color = frame.color.file.filename().string();  // frame-000000.color.png
  return frame.color.file.parent_path() / (color.substr(0, color.find('.')) + ".pose.txt");
}

}  // namespace

std::string frame_files_evidence(const FolderContents& contents) {
  for (const char* ending : kColorEndings) {
    std::string found = contents.find_file("frame-", ending);
    if (!found.empty()) return found;
  }
  return {};
}

RecordedSequence read_frame_files(const std::filesystem::path& folder) {
  constexpr double kRate_hz = 30;
  RecordedSequence sequence;
  sequence.stamps_measured = false;
  sequence.frames =
      pair_by_number(first_listed(folder, kColorEndings), first_listed(folder, kDepthEndings), kRate_hz);
  sequence.ground_truth = truth_of(sequence.frames, [](const RecordedFrame& frame, size_t) {
    const auto file = pose_file_of(frame);
    std::error_code absent;
    return std::filesystem::exists(file, absent) ? rigid_motion(read_matrix(file)) : std::nullopt;
  });
  return sequence;
}

}  // namespace kinloop
