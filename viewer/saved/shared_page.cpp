#include "viewer/saved/shared_page.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/text/base64.hpp"
#include "viewer/gzip.hpp"
#include "viewer/point_files/point_file.hpp"
#include "viewer/scene/incremental_cloud.hpp"
#include "viewer/server/viewer_page.hpp"

namespace kinloop {
namespace {

/// The browser refuses whatever the page would load or send.
constexpr std::string_view kPolicy =
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; connect-src blob: data:; img-src blob: data:; base-uri 'none'; form-action "
    "'none'\">\n";

/// All parts, one after the other, as a browser would receive them.
std::string messages_of(const Scene& scene) {
  std::string messages;
  for (auto part = scene.next_after(0); part; part = scene.next_after(part->version)) {
    const auto header = encode_header({.kind = part->kind,
                                       .index = part->index,
                                       .version = part->version,
                                       .body_bytes = part->body->size()});
    messages.append(header.begin(), header.end());
    messages.append(part->body->begin(), part->body->end());
  }
  return messages;
}

std::string page_of(const SavedRun& run, const std::vector<KeyframeImage>& images) {
  Scene scene("shared");
  show_saved_run(scene, run);
  scene.put(encode_keyframe_images(images));
  constexpr std::string_view kSlot = "<script type=\"application/gzip\" id=\"recording\">";
  std::string page(viewer_page());
  const size_t slot = page.find(kSlot);
  if (slot == std::string::npos)
    throw InputError("this kinloop was built without its pages; kinloop --version says what adds them");
  page.insert(slot + kSlot.size(), base64(gzipped(messages_of(scene))));
  return page.insert(slot, kPolicy);
}

/// Keeps every n-th image, so that all messages take at most so many bytes.
void thin(std::vector<KeyframeImage>& images, size_t max_bytes) {
  const auto bytes_of_every = [&](size_t n) {
    size_t bytes = 0;
    for (size_t i = 0; i < images.size(); i += n) bytes += kHeaderBytes + images[i].jpeg.size();
    return bytes;
  };
  size_t every = 1;
  while (every <= images.size() && bytes_of_every(every) > max_bytes) ++every;
  std::vector<KeyframeImage> kept;
  for (size_t i = 0; i < images.size() && every <= images.size(); i += every)
    kept.push_back(std::move(images[i]));
  images = std::move(kept);
}

ColoredCloud first_points(const ColoredCloud& cloud, size_t count) {
  const auto end = static_cast<long>(count);
  ColoredCloud first;
  first.points.assign(cloud.points.begin(), cloud.points.begin() + end);
  first.colors.assign(cloud.colors.begin(), cloud.colors.begin() + end);
  return first;
}

std::string missing_mesh(const SavedRun& run, const std::filesystem::path& path) {
  std::error_code unreadable;
  if (std::filesystem::is_directory(path, unreadable))
    return fmt::format("{0}: has no mesh; make one with: kinloop mesh {0} -o {1}", path.string(),
                       (path / "mesh.ply").string());
  return fmt::format("{}: has no mesh; share the folder of a run with mesh.ply, or a mesh file",
                     path.empty() ? run.name : path.string());
}

}  // namespace

size_t page_bytes(const char* option, double max_size_mb) {
  if (!(max_size_mb >= kSmallestPageMb && max_size_mb <= kLargestPageMb))
    throw UsageError(
        fmt::format("{} is {}; expected {} to {}", option, max_size_mb, kSmallestPageMb, kLargestPageMb));
  return static_cast<size_t>(std::lround(max_size_mb * kBytesPerMb));
}

void select_contents(SavedRun& run, bool mesh, bool cloud_too, const std::filesystem::path& path) {
  const bool has_mesh = !run.mesh.triangles.empty() || !run.model.empty();
  if (mesh && !has_mesh) throw InputError(missing_mesh(run, path));
  if (mesh && !cloud_too) run.cloud = {};
  if (!mesh && run.cloud.size() > 0) {
    run.mesh = {};
    run.model.clear();
  }
}

SharedPage make_shared_page(SavedRun run, std::vector<KeyframeImage> images, const SharedPageLimits& limits) {
  constexpr size_t kShareOfImages = 4;    // a quarter of what cloud and images may take
  constexpr size_t kLeastPointBytes = 4;  // a point takes more, so that more points do not fit
  constexpr double kMargin = 0.98;        // the size is almost linear in the number of points
  const size_t triangles = run.model.empty() ? run.mesh.triangles.size() : count_glb_triangles(run.model);
  const ColoredCloud cloud = shuffled(run.cloud);
  run.cloud = {};
  run.map_file.clear();  // a path on this machine, of no use to others
  const size_t least_bytes = page_of(run, {}).size();
  if (least_bytes > limits.bytes) {
    throw InputError(
        fmt::format("{}: the page has {:.1f} MB without the cloud and the images, of at most {:.1f} MB; "
                    "raise --max-size or simplify the mesh (kinloop mesh --triangles N)",
                    run.name, static_cast<double>(least_bytes) / kBytesPerMb,
                    static_cast<double>(limits.bytes) / kBytesPerMb));
  }
  thin(images, (limits.bytes - least_bytes) / kShareOfImages * 3 / 4);  // base64 makes 4 bytes of 3
  const size_t bytes_without_points = page_of(run, images).size();
  size_t points = std::min({cloud.size(), limits.points, limits.bytes / kLeastPointBytes});
  while (true) {
    run.cloud = first_points(cloud, points);
    SharedPage page{page_of(run, images), points, images.size(), triangles};
    if (page.html.size() <= limits.bytes) return page;
    const double share = static_cast<double>(limits.bytes - bytes_without_points) /
                         static_cast<double>(page.html.size() - bytes_without_points);
    points = static_cast<size_t>(kMargin * share * static_cast<double>(points));
  }
}

}  // namespace kinloop
