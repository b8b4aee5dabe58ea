// The Bonn RGB-D dynamic dataset (Palazzolo et al. 2019): TUM layout, one camera for all sequences, which are
// recognised by the name of the folder.

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "drivers/datasets/sequence_layout.hpp"

namespace kinloop {
namespace {

std::string bonn_evidence(const std::filesystem::path& folder, const FolderContents&) {
  const std::string name = folder_name(folder);
  return name.starts_with("rgbd_bonn_") && has_tum_lists(folder) ? name : "";
}

RecordedSequence read_bonn(const std::filesystem::path& folder) {
  RecordedSequence sequence = read_tum(folder);
  sequence.layout = "Bonn folder";
  RgbdCamera camera;  // the calibration on the dataset's page
  camera.color = make_lens({640, 480}, 542.822841, 542.576870, 315.593520, 237.756098);
  camera.color.lens = {LensModel::kBrownConrady, 0.039903, -0.099343, -0.000730, -0.000144};
  sequence.camera = camera;
  sequence.sensor = DepthSensorModel::kStructuredLight;  // an Xtion
  return sequence;
}

}  // namespace

SequenceLayout bonn_layout() {
  return {"Bonn", "rgb.txt and depth.txt in a folder named rgbd_bonn_...", bonn_evidence, read_bonn};
}

}  // namespace kinloop
