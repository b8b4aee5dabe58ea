#include "session/store/map_store.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <string_view>
#include <unordered_map>

#include <fmt/format.h>

#include "kinloop/core/association.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/io/run_folder.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"
#include "kinloop/sensor/surfaces/surface_grid.hpp"
#include "kinloop/slam/saved_session.hpp"
#include "session/process.hpp"

namespace kinloop {

namespace {

/// Returns whether an option says how this machine works, not what a map is like: no map file holds it.
bool is_of_the_machine(std::string_view key) {
  return key == "threads" || key.ends_with(".threads");
}

/// Returns whether an option says how much of a map is in memory. A map file has its default, so that equal
/// maps have equal bytes.
bool changes_no_result(std::string_view key) {
  return key.ends_with("_memory_mib");
}

/// Throws InputError naming the file: the value is not of the command line.
void apply_saved(const std::vector<OptionEntry>& entries, const std::filesystem::path& path,
                 const std::string& assignment) {
  try {
    apply_assignment(entries, assignment);
  } catch (const UsageError& error) {
    throw InputError(
        fmt::format("{}: damaged option: {}; map the recording again", path.string(), error.what()));
  }
}

}  // namespace

void MapSaver::save() {
  const Stopwatch watch;
  contents_.recorder.wait_for_jobs();
  SavedMap saved = contents_.slam.saved_map(contents_.input);
  saved.program = program_name();
  RunOptions options = contents_.options, defaults;
  const auto entries = option_entries(options), usual = option_entries(defaults);
  for (size_t i = 0; i < entries.size(); ++i) {
    const std::string& key = entries[i].key;
    if (is_of_the_machine(key)) continue;
    saved.options.emplace_back(key, to_text(changes_no_result(key) ? usual[i].value : entries[i].value));
  }
  write_map(path_, saved, contents_.recorder.image_count(),
            [&](size_t index) { return contents_.recorder.saved_images(index); });
  latest_ = watch.elapsed();
  total_ += latest_;
}

bool MapSaver::try_save() {
  bool saved = true;
  try {
    save();
  } catch (const InputError& error) {
    log::error("cannot save the map: {}", error.what());
    saved = false;
  }
  since_last_save_ = {};
  return saved;
}

void MapSaver::save_if_due() {
  constexpr double kMaxShare = 0.05;  // share of the time that saving may take
  if (interval_s_ > 0 && since_last_save_.wall_s() >= std::max(interval_s_, latest_.wall_s / kMaxShare))
    try_save();
}

std::filesystem::path map_file_of(const std::filesystem::path& file_or_folder) {
  if (!std::filesystem::is_directory(file_or_folder)) return file_or_folder;
  auto path = file_or_folder / kMapFileName;
  if (!std::filesystem::exists(path)) {
    throw InputError(fmt::format("{}: has no {}; specify a map file or the folder of a run",
                                 file_or_folder.string(), kMapFileName));
  }
  return path;
}

void require_images(size_t count, const std::filesystem::path& map) {
  if (count > 0) return;
  throw InputError(
      fmt::format("{}: holds no images with known poses; map the recording again", map.string()));
}

SavedMap read_map_with_warnings(const MapReader& reader, const std::filesystem::path& path) {
  auto [saved, damage] = reader.read();
  if (damage.any()) log::warn("{}: damaged; lost: {}", path.string(), describe(damage));
  return std::move(saved);
}

void load_images(const MapReader& reader, const std::filesystem::path& path, uint32_t shift,
                 DenseRecorder& recorder) {
  MapDamage damage;
  damage.images = reader.read_images([&](SavedImages images) {
    images.frame.value += shift;
    recorder.restore(images);
  });
  if (damage.any()) log::warn("{}: damaged; lost: {}", path.string(), describe(damage));
}

void restore_surfaces(SavedMap& saved, const MapReader& reader) {
  const auto camera = make_surface_camera(make_sensor(saved.camera));
  const ImageEncoding stored{.depth_scale = saved.camera.depth_scale};
  std::unordered_map<FrameId, Keyframe*> keyframe_of;
  for (Keyframe& keyframe : saved.map.keyframes) keyframe_of.emplace(keyframe.frame, &keyframe);
  reader.read_images([&](const SavedImages& images) {
    const auto keyframe = keyframe_of.find(images.frame);
    if (keyframe == keyframe_of.end()) return;
    const cv::Mat depth_m = decode_images(images.images, stored).depth_m;
    keyframe->second->surfaces = std::make_shared<const SurfaceGrid>(make_surface_grid(camera, depth_m));
  });
}

RunOptions restore_options(const SavedMap& saved, const std::filesystem::path& path,
                           const std::string& prefix) {
  using Kind = ResolvedKey::Kind;
  RunOptions restored;
  const auto entries = option_entries(restored);
  const OptionHistory history = option_history<RunOptions>();
  std::set<std::string> applied;
  // Where several former options are one now, its own name comes first, then the first of theirs. Other
  // versions of the program may have options that this one does not have.
  for (const Kind kind : {Kind::kCurrent, Kind::kRenamed}) {
    for (const auto& [name, value] : saved.options) {
      const ResolvedKey resolved = resolve_key(entries, name, history);
      if (resolved.kind != kind || !resolved.key.starts_with(prefix)) continue;
      if (is_of_the_machine(resolved.key)) continue;  // of maps up to version 0.1
      if (applied.insert(resolved.key).second)
        apply_saved(entries, path, fmt::format("{}={}", resolved.key, value));
    }
  }
  return restored;
}

std::string other_camera(const SavedMap& saved, const std::filesystem::path& path, const RgbdCamera& camera) {
  const PinholeCamera& lens = saved.camera.color;
  if (lens == camera.color) return {};
  return fmt::format("{}: was recorded with another camera ({}x{}, fx {}, fy {}, cx {}, cy {})",
                     path.string(), lens.width, lens.height, lens.fx, lens.fy, lens.cx, lens.cy);
}

void require_same_camera(const SavedMap& saved, const std::filesystem::path& path, const RgbdCamera& camera) {
  const std::string other = other_camera(saved, path, camera);
  if (!other.empty()) throw InputError(other + "; specify it with --camera");
}

std::optional<ContinuedMap> open_continued_map(const std::filesystem::path& file_or_folder) {
  if (file_or_folder.empty()) return std::nullopt;
  const auto path = map_file_of(file_or_folder);
  MapReader reader(path);
  SavedMap saved = read_map_with_warnings(reader, path);
  return ContinuedMap{path, std::move(reader), std::move(saved)};
}

RgbdCamera ContinuedMap::adapt(RgbdCamera camera) const {
  require_same_camera(saved, path, camera);
  camera.depth_scale = saved.camera.depth_scale;
  return camera;
}

void ContinuedMap::restore_images(uint32_t shift, DenseRecorder& recorder) const {
  load_images(reader, path, shift, recorder);
}

FileFrame file_frame(const std::string& name, const UpEstimate& up, std::span<const PosedImage> views) {
  if (name == "camera") return {};
  return z_up_frame(up.direction, views.empty() ? SE3() : views.front().T_world_camera);
}

FileCloud file_cloud(const FileCloudRequest& request, OpenMap& open, const Progress& progress) {
  FileCloud result{file_frame(request.frame, open.up(request.session), open.views(request.session)), {}};
  if (request.with_cloud) result.cloud = open.cloud(request.session, request.threads, progress);
  return result;
}

OpenMap open_map(const std::filesystem::path& file_or_folder, const std::vector<std::string>& assignments,
                 const std::filesystem::path& poses) {
  const auto path = map_file_of(file_or_folder);
  const MapReader reader(path);
  SavedMap saved = read_map_with_warnings(reader, path);
  const RunOptions options =
      within_range(run_options_with(restore_options(saved, path), assignments), saved.camera.sensor);
  OpenMap open{{}, options, {}, logged_frames(saved, 0, 0), DenseRecorder(saved.camera, options.dense), {}};
  open.map.append(std::move(saved.map));
  open.saved = std::move(saved);
  load_images(reader, path, 0, open.recorder);
  if (!poses.empty()) open.poses = read_tum_trajectory(poses);
  return open;
}

namespace {

/// Velocity of the camera at a stamp; zero if the poses do not determine it.
Velocity velocity_at(const Trajectory& poses, int64_t stamp_ns) {
  constexpr int64_t kStepNs = kNsPerSecond / 60;
  const auto before = pose_at(poses, stamp_ns - kStepNs, kMaxAssociationNs * 2);
  const auto after = pose_at(poses, stamp_ns + kStepNs, kMaxAssociationNs * 2);
  if (!before || !after) return Velocity{};
  return velocity_between(*before, *after, to_seconds(2 * kStepNs));
}

}  // namespace

uint32_t OpenMap::component(size_t number) const {
  return main_component(session_log(number), map);
}

std::vector<PosedImage> OpenMap::views(size_t number) const {
  if (poses.empty()) return recorder.views(log, map, component(number));
  std::unordered_map<FrameId, const LoggedFrame*> entry_of;
  for (const LoggedFrame& entry : log) entry_of.emplace(entry.id, &entry);
  std::vector<PosedImage> views;
  for (size_t i = 0; i < recorder.image_count(); ++i) {
    const auto entry = entry_of.find(recorder.frame_of_image(i));
    if (entry == entry_of.end()) continue;
    const LoggedFrame& frame = *entry->second;
    const auto T_world_camera = pose_at(poses, frame.stamp_ns, kMaxAssociationNs * 2);
    if (!T_world_camera) continue;
    views.push_back({i, *T_world_camera, velocity_at(poses, frame.stamp_ns),
                     static_cast<double>(frame.depth_stamp_difference_s)});
  }
  return views;
}

DenseCamera OpenMap::dense_camera() const {
  const SensorEstimate estimate = sensor_estimate(saved.sensor, make_sensor(saved.camera));
  return poses.empty() ? kinloop::dense_camera(saved.camera, estimate)
                       : time_calibrated_camera(saved.camera, estimate);
}

double OpenMap::rolling_shutter_s() const {
  return sensor_estimate(saved.sensor, make_sensor(saved.camera)).sensor.corrections(kRollingShutter);
}

ColoredCloud OpenMap::cloud(size_t number, int threads, const Progress& progress) {
  return recorder.fuse_views(views(number), dense_camera(), threads, progress);
}

size_t OpenMap::session_index(size_t number) const {
  const size_t count = saved.sessions.size();
  if (number > count) {
    throw UsageError(fmt::format("--session {}: the map has {} sessions", number, count));
  }
  return (number == 0 ? count : number) - 1;
}

std::span<const LoggedFrame> OpenMap::session_log(size_t number) const {
  const auto& sessions = saved.sessions;
  if (sessions.empty() && number == 0) return log;
  const size_t index = session_index(number);
  const auto at = [&](FrameId first) {
    return std::find_if(log.begin(), log.end(), [=](const LoggedFrame& entry) { return entry.id >= first; });
  };
  const auto begin = at(sessions[index].first_frame);
  const auto end = index + 1 < sessions.size() ? at(sessions[index + 1].first_frame) : log.end();
  return {begin, end};
}

}  // namespace kinloop
