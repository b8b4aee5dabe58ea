#include "drivers/datasets/open_sequence.hpp"

#include "drivers/datasets/camera_files/fit_to_images.hpp"
#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/lists/pair_images.hpp"
#include "drivers/datasets/recorded_source.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "drivers/datasets/truth/truth.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/sensor/camera/possible_camera.hpp"

namespace kinloop {
namespace {

OpenedSequence read_folder(const LocatedSequence& located,
                           const std::optional<CameraArgument>& camera_argument,
                           std::optional<double> depth_scale) {
  const std::filesystem::path& path = located.folder;
  const SequenceLayout* layout = recognise_layout(path);
  if (layout == nullptr) reject_sequence(path, camera_argument.has_value());
  OpenedSequence opened{layout->read(path), {}, located.shown_name};
  opened.sequence.unpacked = located.unpacked;
  if (!depth_scale && has_floats_in_metres(opened.sequence))
    opened.sequence.depth_encoding = DepthEncoding::kFloatImage;
  opened.camera = camera_of_sequence(path, opened.sequence, camera_argument, depth_scale, located.top);
  if (opened.sequence.sensor) opened.camera.sensor.set_by_source(*opened.sequence.sensor);
  opened.camera.has_metric_depth = is_metric(opened.sequence.depth_encoding);
  require_possible(opened.camera, path.string());
  find_truth(path, opened.camera, opened.sequence);
  return opened;
}

}  // namespace

OpenedSequence read_located(const LocatedSequence& located,
                            const std::optional<CameraArgument>& camera_argument,
                            std::optional<double> depth_scale) {
  return with_shown_paths(located, [&] { return read_folder(located, camera_argument, depth_scale); });
}

OpenedSequence read_sequence(const std::filesystem::path& path,
                             const std::optional<CameraArgument>& camera_argument,
                             std::optional<double> depth_scale, const std::string& name) {
  return read_located(locate_sequence(path, name), camera_argument, depth_scale);
}

std::unique_ptr<FrameSource> open_sequence(const std::string& path,
                                           const std::optional<CameraArgument>& camera_argument,
                                           std::optional<double> depth_scale, const std::string& name) {
  const LocatedSequence located = locate_sequence(path, name);
  OpenedSequence opened = read_located(located, camera_argument, depth_scale);
  tell_pairing(opened.name, opened.sequence.pairing);
  return with_shown_paths(located, [&] {
    return std::make_unique<RecordedSource>(opened.name, std::move(opened.sequence), opened.camera);
  });
}

}  // namespace kinloop
