#include "session/store/export_sparse_model.hpp"

#include <unordered_map>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "session/store/recorded_images.hpp"
#include "tools/export/sparse_model/colmap.hpp"
#include "tools/export/sparse_model/model_images.hpp"
#include "tools/export/sparse_model/nerfstudio.hpp"

namespace kinloop {
namespace {

std::vector<FrameImage> model_views(const OpenMap& open, const std::vector<PosedImage>& views) {
  std::unordered_map<FrameId, int64_t> stamp_of;
  for (const LoggedFrame& entry : open.log) stamp_of.emplace(entry.id, entry.stamp_ns);
  std::vector<FrameImage> with_frames;
  for (const PosedImage& view : views) {
    const FrameId frame = open.recorder.frame_of_image(view.image);
    with_frames.push_back({frame, view, stamp_of.at(frame)});
  }
  return with_frames;
}

ImageUndistorter make_undistorter(const OpenMap& open, const std::filesystem::path& map) {
  try {
    return ImageUndistorter(open.dense_camera(), open.rolling_shutter_s());
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", map.string(), error.what()));
  }
}

}  // namespace

void export_sparse_model(const SparseModelRequest& request, const FileCloud& file, OpenMap& open,
                         const Progress& progress) {
  const ImageUndistorter undistorter = make_undistorter(open, request.map);
  add_recorded_images(open, {request.map, request.recording, request.session, request.images}, progress);
  const auto views = open.views(request.session);
  SparseModel model = make_sparse_model(open.map, model_views(open, views), undistorter, file.frame);
  require_images(model.images.size(), request.map);
  add_cloud_points(model, file.cloud, request.points);
  const bool same_folder = request.colmap == request.nerfstudio;
  const auto write_images = [&](const std::filesystem::path& folder, bool depth) {
    write_model_images(folder, model, open.recorder.images(), undistorter, {depth, request.threads},
                       progress);
  };
  if (!request.nerfstudio.empty()) {
    write_images(request.nerfstudio, true);
    write_nerfstudio(request.nerfstudio, model);
  }
  if (!request.colmap.empty()) {
    if (!same_folder) write_images(request.colmap, false);
    write_colmap_model(request.colmap, model);
  }
}

}  // namespace kinloop
