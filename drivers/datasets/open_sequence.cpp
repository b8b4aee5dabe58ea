#include "drivers/datasets/open_sequence.hpp"

#include "drivers/datasets/camera_files/fit_to_images.hpp"
#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/lists/pair_images.hpp"
#include "drivers/datasets/recorded_source.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "drivers/datasets/sequences_below.hpp"
#include "drivers/datasets/truth/truth.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/sensor/camera/possible_camera.hpp"

namespace kinloop {
OpenedSequence read_sequence(const std::filesystem::path& given_path,
                             const std::optional<CameraArgument>& camera_argument,
                             std::optional<double> depth_scale, const std::string& name) {
  const std::filesystem::path path = sequence_folder(given_path, name);
  if (path != given_path && name.empty())
    log::info("{}: contains one sequence, {}, which is taken", given_path.string(), path.string());
  const SequenceLayout* layout = recognise_layout(path);
  if (layout == nullptr) reject_sequence(path, camera_argument.has_value());
  OpenedSequence opened{layout->read(path), {}};
  if (!depth_scale && has_floats_in_metres(opened.sequence))
    opened.sequence.depth_encoding = DepthEncoding::kFloatImage;
  opened.camera = camera_of_sequence(path, opened.sequence, camera_argument, depth_scale, given_path);
  if (opened.sequence.sensor) opened.camera.sensor.set_by_source(*opened.sequence.sensor);
  opened.camera.has_metric_depth = is_metric(opened.sequence.depth_encoding);
  require_possible(opened.camera, path.string());
  find_truth(path, opened.camera, opened.sequence);
  return opened;
}

std::unique_ptr<FrameSource> open_sequence(const std::string& path,
                                           const std::optional<CameraArgument>& camera_argument,
                                           std::optional<double> depth_scale, const std::string& name) {
  OpenedSequence opened = read_sequence(path, camera_argument, depth_scale, name);
  const std::string full_name = name.empty() ? path : sequence_folder(path, name).string();
  tell_pairing(full_name, opened.sequence.pairing);
  return std::make_unique<RecordedSource>(full_name, std::move(opened.sequence), opened.camera);
}

}  // namespace kinloop
