// Replica as rendered for iMAP and NICE-SLAM: results/frame000000.jpg, results/depth000000.png, traj.txt with
// a 4x4 pose per line, and cam_params.json in the folder or above it.

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/json_file.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "drivers/datasets/reading/two_lenses.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

std::string replica_evidence(const fs::path& folder, const FolderContents& contents) {
  if (!contents.has_folder("results") || !contents.has_file("traj.txt")) return {};
  const std::string frame = FolderContents(folder / "results").find_file("frame", ".jpg");
  return frame.empty() ? frame : fmt::format("results/{}, traj.txt", frame);
}

std::optional<RgbdCamera> read_replica_camera(const fs::path& folder) {
  for (const fs::path& file :
       {folder / "cam_params.json", folder.lexically_normal().parent_path() / "cam_params.json"}) {
    std::error_code absent;
    if (!fs::exists(file, absent)) continue;
    const auto json = read_json(file);
    const auto& camera = json.contains("camera") ? json["camera"] : json;
    const auto number = [&](const char* key) { return number_at(camera, key, file); };
    const PinholeCamera lens = checked_lens(make_lens(checked_size(number("w"), number("h"), file),
                                                      number("fx"), number("fy"), number("cx"), number("cy")),
                                            file);
    return camera_of({lens, lens, {}, {}}, number("scale"), file);
  }
  return std::nullopt;
}

RecordedSequence read_replica(const fs::path& folder) {
  constexpr double kRate_hz = 30;
  constexpr size_t kMatrix = 16;
  RecordedSequence sequence;
  sequence.layout = "Replica folder";
  sequence.stamps_measured = false;
  sequence.camera = read_replica_camera(folder);
  sequence.camera_remedy = "no cam_params.json in the folder or above it; copy it from the dataset";
  const fs::path results = folder / "results";
  const auto color = numbered_files(results, "frame", ".jpg");
  sequence.frames = pair_by_number(color, numbered_files(results, "depth", ".png"), kRate_hz);
  const fs::path file = folder / "traj.txt";
  const auto numbers = read_numbers(file);
  if (numbers.size() % kMatrix != 0) {
    throw InputError(fmt::format("{}: {} numbers, where each line has {}; copy it again", file.string(),
                                 numbers.size(), kMatrix));
  }
  sequence.ground_truth =
      truth_of(sequence.frames, [&](const RecordedFrame& frame, size_t) -> std::optional<SE3> {
        const auto number = numbered_name(frame.color.file, "frame", ".jpg");
        if (!number || *number >= numbers.size() / kMatrix) return std::nullopt;
        return rigid_motion(*matrix_of(std::span(numbers).subspan(*number * kMatrix, kMatrix)));
      });
  return sequence;
}

}  // namespace

SequenceLayout replica_layout() {
  return {"Replica", "results/frame000000.jpg, results/depth000000.png and traj.txt", replica_evidence,
          read_replica};
}

}  // namespace kinloop
