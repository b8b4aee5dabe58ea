#pragma once
// In: a saved run. Out: the viewer's page with the run inside, one HTML file that needs no server.

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "viewer/keyframe_images.hpp"
#include "viewer/saved_run.hpp"

namespace kinloop {

struct SharedPageLimits {
  size_t bytes = 20'000'000;                           ///< of the page
  size_t points = std::numeric_limits<size_t>::max();  ///< of the cloud
};

/// The images of keyframes for such a page.
constexpr KeyframeImageOptions kSharedImages{.most = 200, .width_px = 320, .quality = 70};

struct SharedPage {
  std::string html;
  size_t points = 0, images = 0;  ///< that are in it
};

/// Leaves of a run its cloud or, if `mesh`, its mesh and on request the cloud, too. Throws InputError naming
/// `path`, where the run was read, if it has no mesh.
void select_contents(SavedRun& run, bool mesh, bool cloud_too, const std::filesystem::path& path);

/// Returns the page with as much of the cloud and of the images as fits; both are thinned evenly. Throws
/// InputError if even without the cloud it is larger than the limit, or if this build has no pages.
SharedPage make_shared_page(SavedRun run, std::vector<KeyframeImage> images, const SharedPageLimits& limits);

}  // namespace kinloop
