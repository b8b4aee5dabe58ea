#pragma once
// In: a saved run. Out: the viewer's page with the run inside, one HTML file that needs no server.

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "viewer/saved/keyframe_images.hpp"
#include "viewer/saved/saved_run.hpp"

namespace kinloop {

constexpr double kBytesPerMb = 1e6;
constexpr double kSmallestPageMb = 1, kLargestPageMb = 100;  ///< what may be asked for

struct SharedPageLimits {
  size_t bytes = 20'000'000;                           ///< of the page
  size_t points = std::numeric_limits<size_t>::max();  ///< of the cloud
};

/// The images of keyframes for such a page.
constexpr KeyframeImageOptions kSharedImages{.most = 200, .width_px = 320, .quality = 70};

struct SharedPage {
  std::string html;
  size_t points = 0, images = 0;  ///< in the page
  size_t triangles = 0;           ///< of the mesh in the page
};

/// Returns a limit in bytes. Throws UsageError naming `option` if it is out of the range above or NaN.
size_t page_bytes(const char* option, double max_size_mb);

/// Keeps the cloud of a run or, if `mesh`, its mesh, and the cloud too on request. Throws InputError naming
/// `path`, where the run was read (empty: not from a file), if it has no mesh.
void select_contents(SavedRun& run, bool mesh, bool cloud_too, const std::filesystem::path& path);

/// Returns the page with as much of the cloud and of the images as fits; both are thinned evenly, and the
/// images take at most a quarter of the room for both. Throws InputError if even without both it is larger
/// than the limit, or if this build has no pages.
SharedPage make_shared_page(SavedRun run, std::vector<KeyframeImage> images, const SharedPageLimits& limits);

}  // namespace kinloop
