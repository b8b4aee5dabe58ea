#include "drivers/datasets/tum_source.hpp"

#include "drivers/datasets/camera_selection.hpp"
#include "drivers/datasets/layouts/layouts.hpp"

namespace kinloop {

TumSource::TumSource(const std::filesystem::path& folder) : TumSource(folder, choose_camera(folder)) {}

TumSource::TumSource(const std::filesystem::path& folder, const RgbdCamera& camera)
    : RecordedSource(folder.string(), read_tum(folder), camera) {}

}  // namespace kinloop
