#include "session/store/export_sparse_model.hpp"

#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "session/source/open_frame_source.hpp"
#include "tools/export/sparse_model/sparse_model.hpp"

namespace kinloop {
namespace {

using FrameAtStamp = std::unordered_map<int64_t, FrameId>;

/// Frames with a trusted pose and no image, so many that `count` have one, evenly spread.
FrameAtStamp frames_to_read(const OpenMap& open, size_t session, size_t count) {
  const size_t known = open.views(session).size();
  std::unordered_set<FrameId> with_image;
  for (size_t i = 0; i < open.recorder.image_count(); ++i) with_image.insert(open.recorder.frame_of_image(i));
  std::vector<const LoggedFrame*> candidates;
  for (const LoggedFrame& entry : open.session_log(session)) {
    const bool is_trusted = !entry.is_lost() && !entry.is_doubtful();
    if (is_trusted && entry.method != TrackingMethod::kPredicted && !with_image.contains(entry.id))
      candidates.push_back(&entry);
  }
  FrameAtStamp chosen;
  const size_t missing = std::min(count - std::min(count, known), candidates.size());
  for (size_t i = 0; i < missing; ++i) {
    const LoggedFrame& frame = *candidates[(2 * i + 1) * candidates.size() / (2 * missing)];
    chosen.emplace(frame.stamp_ns, frame.id);
  }
  return chosen;
}

std::string recording_of(const OpenMap& open, const RecordedImagesRequest& request) {
  if (!request.recording.empty()) return request.recording;
  if (open.saved.sessions.empty())
    throw UsageError(
        fmt::format("{}: does not name its recording; give it with --recording", request.map.string()));
  const std::string& input = open.saved.sessions[open.session_index(request.session)].input;
  if (source_kind(input) == SourceKind::kLive)
    throw UsageError(
        fmt::format("{}: was made of {}, whose frames are gone; give a recording of them with "
                    "--recording, or use --set dense.frame_step=N in the run",
                    request.map.string(), input));
  return input;
}

std::unique_ptr<FrameSource> open_recording(const OpenMap& open, const RecordedImagesRequest& request) {
  SourceRequest source;
  source.sequence = recording_of(open, request);
  source.simulation = open.options.sim;
  if (!source.sequence.starts_with("sim:")) source.camera = open.saved.camera;
  try {
    auto recording = open_frame_source(source);
    require_same_camera(open.saved, request.map, recording->camera());
    return recording;
  } catch (const InputError& error) {
    if (!request.recording.empty()) throw;
    throw InputError(
        fmt::format("{} (--recording names the recording of {})", error.what(), request.map.string()));
  }
}

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

void add_recorded_images(OpenMap& open, const RecordedImagesRequest& request, const Progress& progress) {
  if (request.count == 0) return;
  const FrameAtStamp wanted = frames_to_read(open, request.session, request.count);
  if (!wanted.empty()) {
    const auto recording = open_recording(open, request);
    size_t found = 0;
    while (found < wanted.size()) {
      const auto frame = recording->next();
      if (!frame) break;
      const auto entry = wanted.find(frame->stamp_ns);
      if (entry == wanted.end()) continue;
      const ImageEncoding& encoding = open.recorder.images().encoding();
      open.recorder.restore({entry->second, encode_images(frame->color, frame->depth_m, encoding).encoded});
      report(progress, "reading images", ++found, wanted.size());
    }
    if (found == 0)
      throw InputError(fmt::format("{}: has none of the frames of {}; name its recording with --recording",
                                   recording->info().name, request.map.string()));
  }
  const size_t images = open.views(request.session).size();
  if (images < request.count)
    log::warn("{}: only {} images have a trusted pose, not {}", request.map.string(), images, request.count);
}

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
