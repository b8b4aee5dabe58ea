// The TUM RGB-D benchmark (Sturm et al. 2012), the layout that kinloop itself writes.

#include <array>

#include "drivers/datasets/camera_selection.hpp"
#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/lists/frame_masks.hpp"
#include "drivers/datasets/reading/lists/tum_listing.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/geometry/ground_truth.hpp"

namespace kinloop {
namespace {

std::string tum_evidence(const std::filesystem::path& folder, const FolderContents&) {
  return has_tum_lists(folder) ? "rgb.txt, depth.txt" : "";
}

RecordedSequence read_tum_with_preset(const std::filesystem::path& folder) {
  RecordedSequence sequence = read_tum(folder);
  sequence.camera = preset_of_folder(folder);
  return sequence;
}

}  // namespace

RecordedSequence read_tum(const std::filesystem::path& folder) {
  RecordedSequence sequence;
  sequence.layout = "TUM folder";
  TumListing listing = read_tum_listing(folder);
  sequence.frames = std::move(listing.frames);
  sequence.skipped = std::move(listing.skipped);
  sequence.pairing = std::move(listing.pairing);
  find_masks(folder, sequence);
  const auto ground_truth = folder / "groundtruth.txt";
  if (std::filesystem::exists(ground_truth)) {
    sequence.ground_truth = read_ground_truth(ground_truth);
    if (sequence.ground_truth.empty())
      log::warn("{}: contains no pose: the trajectory error will not be computed", ground_truth.string());
  }
  return sequence;
}

SequenceLayout tum_layout() {
  return {"TUM", "rgb.txt and depth.txt, or associations.txt", tum_evidence, read_tum_with_preset};
}

}  // namespace kinloop
