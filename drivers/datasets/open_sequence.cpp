#include "drivers/datasets/open_sequence.hpp"

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/recorded_source.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "kinloop/sensor/camera/possible_camera.hpp"

namespace kinloop {
namespace {

std::optional<RgbdCamera> camera_given(const std::filesystem::path& path,
                                       const std::optional<CameraArgument>& camera_argument) {
  if (camera_argument) return choose_camera(path, camera_argument);
  const auto file = path / "camera.yaml";
  std::error_code absent;
  return std::filesystem::exists(file, absent) ? std::optional(read_camera_file(file)) : std::nullopt;
}

}  // namespace

OpenedSequence read_sequence(const std::filesystem::path& path,
                             const std::optional<CameraArgument>& camera_argument) {
  const SequenceLayout* layout = recognise_layout(path);
  if (layout == nullptr) reject_sequence(path, camera_argument.has_value());
  const auto given = camera_given(path, camera_argument);
  OpenedSequence opened{layout->read(path), {}};
  if (!given && !opened.sequence.camera) reject_without_camera(path, opened.sequence.camera_remedy);
  opened.camera = given ? *given : *opened.sequence.camera;
  if (opened.sequence.sensor) opened.camera.sensor.set_by_source(*opened.sequence.sensor);
  require_possible(opened.camera, path.string());
  return opened;
}

std::unique_ptr<FrameSource> open_sequence(const std::string& path,
                                           const std::optional<CameraArgument>& camera_argument) {
  OpenedSequence opened = read_sequence(path, camera_argument);
  return std::make_unique<RecordedSource>(path, std::move(opened.sequence), opened.camera);
}

}  // namespace kinloop
