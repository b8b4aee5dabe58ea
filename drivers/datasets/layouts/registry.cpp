#include <array>

#include "drivers/datasets/layouts/layouts.hpp"

namespace kinloop {

std::span<const SequenceLayout> sequence_layouts() {
  static const std::array kLayouts = {
      icl_nuim_layout(),       eth3d_layout(),         bonn_layout(),         tum_layout(),
      open_loris_layout(),     bundle_fusion_layout(), seven_scenes_layout(), scannet_layout(),
      sens_layout(),           replica_layout(),       tartan_air_layout(),   stray_scanner_layout(),
      scanner_3d_app_layout(), polycam_layout(),       record3d_layout(),     record3d_export_layout(),
      transforms_layout(),     redwood_layout(),       listed_layout(),       plain_layout(),
      flat_layout(),
  };
  return kLayouts;
}

const SequenceLayout* recognise_layout(const std::filesystem::path& path) {
  const FolderContents contents(path);
  for (const SequenceLayout& layout : sequence_layouts()) {
    if (!layout.evidence(path, contents).empty()) return &layout;
  }
  return nullptr;
}

}  // namespace kinloop
