#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_stream.hpp"
#include "kinloop/io/map_file/camera_values.hpp"
#include "kinloop/io/map_file/feature_serialization.hpp"
#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/io/map_file/map_tables.hpp"
#include "kinloop/io/map_file/row_values.hpp"

namespace kinloop {
namespace {

namespace tables = map_tables;

std::map<std::string, double> read_camera(const DatabaseReader& file) {
  std::map<std::string, double> camera;
  file.read(tables::kCamera, [&](int64_t, const Row& cells) {
    RowReader row(cells);
    const auto name = row.take<std::string>();
    camera[name] = row.take<double>();
    return row.exhausted();
  });
  return camera;
}

std::map<std::string, Cell> read_about(const DatabaseReader& file) {
  std::map<std::string, Cell> about;
  file.read(tables::kAbout, [&](int64_t, const Row& row) {
    if (row.size() == 2 && std::holds_alternative<std::string>(row[0]))
      about[std::get<std::string>(row[0])] = row[1];
    return true;
  });
  return about;
}

/// Reads options, sessions and sensor parameters; returns whether all are intact.
bool read_settings(const DatabaseReader& file, SavedMap& map) {
  const auto sessions = file.read(tables::kSession, [&](int64_t, const Row& cells) {
    RowReader row(cells);
    auto input = row.take<std::string>();
    const SavedSession session{std::move(input), FrameId{take_index(row, kMaxFrames)}};
    const bool in_order = map.sessions.empty() || session.first_frame >= map.sessions.back().first_frame;
    if (!row.exhausted() || !in_order) return false;
    map.sessions.push_back(session);
    return true;
  });
  const auto options = file.read(tables::kOption, [&](int64_t, const Row& cells) {
    RowReader row(cells);
    auto key = row.take<std::string>();
    auto value = row.take<std::string>();
    if (!row.exhausted()) return false;
    map.options.emplace_back(std::move(key), std::move(value));
    return true;
  });
  const auto sensor = file.read(tables::kSensor, [&](int64_t, const Row& cells) {
    RowReader row(cells);
    const double value = row.take_in(-kMaxParameter, kMaxParameter), sigma = row.take_in(0.0, kUnconstrained);
    const SavedParameter parameter{value, sigma, row.take<int64_t>() != 0};
    if (!row.exhausted()) return false;
    map.sensor.push_back(parameter);
    return true;
  });
  return !sessions.any() && !options.any() && !sensor.any();
}

/// The keyframes by their ids in the file.
std::map<uint32_t, Keyframe> read_keyframes(const DatabaseReader& file) {
  std::map<uint32_t, Keyframe> keyframes;
  file.read(tables::kKeyframe, [&](int64_t id, const Row& cells) {
    if (id < 0 || id >= kMaxKeyframes) return false;
    RowReader row(cells);
    Keyframe keyframe;
    keyframe.frame = FrameId{take_index(row, kMaxFrames)};
    keyframe.stamp_ns = take_stamp(row);
    keyframe.component = take_index(row, kMaxKeyframes);  // each begins with a keyframe
    keyframe.begins_component = row.take<int64_t>() != 0;
    keyframe.T_world_camera = take_pose(row);
    auto features = deserialize_features(row.take<Blob>().bytes);
    keyframe.visit =
        row.exhausted() ? keyframe.component : take_index(row, kMaxKeyframes);  // since version 4
    if (!features || !row.exhausted()) return false;
    keyframe.features = std::make_shared<const Features>(std::move(*features));
    keyframes.emplace(static_cast<uint32_t>(id), std::move(keyframe));
    return true;
  });
  return keyframes;
}

/// New ids of the keyframes that could be read, by their old ids.
using Renumbered = std::unordered_map<uint32_t, uint32_t>;

KeyframeId new_id(const Renumbered& ids, KeyframeId old) {
  const auto found = ids.find(old.value);
  return found == ids.end() ? KeyframeId{} : KeyframeId{found->second};
}

/// Renumbers without gaps; if the first keyframe of a visit is lost, the next one begins it.
Renumbered take_keyframes(const std::map<uint32_t, Keyframe>& raw, MapData& map) {
  Renumbered ids;
  std::set<uint32_t> begun;
  for (const auto& [id, as_read] : raw) {
    Keyframe keyframe = as_read;
    ids[id] = static_cast<uint32_t>(map.keyframes.size());
    keyframe.id = KeyframeId{ids[id]};
    if (begun.insert(keyframe.visit).second) keyframe.begins_component = true;
    map.component_count = std::max({map.component_count, keyframe.component + 1, keyframe.visit + 1});
    map.keyframes.push_back(std::move(keyframe));
  }
  return ids;
}

/// Keypoints assigned to a landmark.
using Claims = std::set<Observation>;

/// The landmark with its valid observations; nullopt if its anchor is lost.
std::optional<Landmark> sound(Landmark landmark, const Renumbered& ids, const MapData& map, Claims& claims) {
  std::vector<Observation> kept;
  std::set<KeyframeId> observers;
  landmark.anchor = new_id(ids, landmark.anchor);
  for (Observation seen : landmark.observations) {
    seen.keyframe = new_id(ids, seen.keyframe);
    if (!seen.keyframe.valid() || seen.feature >= map.keyframes[seen.keyframe.value].features->size())
      continue;
    if (claims.contains(seen) || !observers.insert(seen.keyframe).second) continue;
    kept.push_back(seen);
  }
  if (!observers.contains(landmark.anchor)) return std::nullopt;
  claims.insert(kept.begin(), kept.end());
  landmark.observations = std::move(kept);
  return landmark;
}

/// Landmarks are created at keypoints, rarely twice at the same one. Their ids have gaps where some were
/// erased; beyond this limit an id is damaged, and the table indexed by ids would be absurdly large.
int64_t landmark_limit(const MapData& map) {
  constexpr size_t kPerKeypoint = 4;
  size_t keypoints = 0;
  for (const Keyframe& keyframe : map.keyframes) keypoints += keyframe.features->size();
  return static_cast<int64_t>(kPerKeypoint * keypoints);
}

size_t read_landmarks(const DatabaseReader& file, const Renumbered& ids, MapData& map) {
  Claims claims;
  size_t count = 0;
  const int64_t limit = landmark_limit(map);
  file.read(tables::kLandmark, [&](int64_t id, const Row& cells) {
    if (id < 0 || id >= limit) return false;
    RowReader row(cells);
    Landmark landmark;
    landmark.id = LandmarkId{static_cast<uint32_t>(id)};
    landmark.anchor = take_keyframe(row);
    for (int i = 0; i < 3; ++i) landmark.p_anchor(i) = row.take_in(-kMaxDistanceM, kMaxDistanceM);
    const Blob observations = row.take<Blob>();
    ValueReader reader(observations.bytes);
    landmark.observations = reader.list<Observation>();
    if (!reader.exhausted() || !row.exhausted()) return false;
    auto whole = sound(std::move(landmark), ids, map, claims);
    if (!whole) return false;
    map.landmarks.resize(static_cast<size_t>(id) + 1);
    map.landmarks.back() = std::move(whole);
    ++count;
    return true;
  });
  return count;
}

/// Reads what edges and other loops have, but the support. nullopt if its keyframes are lost or it is
/// damaged.
std::optional<LoopClosure> take_loop(RowReader& row, const Renumbered& ids) {
  LoopClosure loop;
  loop.a = new_id(ids, take_keyframe(row));
  loop.b = new_id(ids, take_keyframe(row));
  loop.T_a_b = take_pose(row);
  const Blob information = row.take<Blob>();
  ValueReader reader(information.bytes);
  reader.copy(loop.information.data(), static_cast<size_t>(loop.information.size()));
  loop.evidence.inliers = static_cast<int>(row.take_in<int64_t>(0, kMaxInliers));
  const bool whole = reader.exhausted() && is_information(loop.information);
  if (!whole || !loop.a.valid() || !loop.b.valid() || loop.a == loop.b) return std::nullopt;
  return loop;
}

int take_support(RowReader& row) {
  return static_cast<int>(row.take_in<int64_t>(1, kMaxKeyframes));
}

void read_loop_closures(const DatabaseReader& file, const Renumbered& ids, MapData& map) {
  file.read(tables::kLoopEdge, [&](int64_t, const Row& cells) {
    RowReader row(cells);
    auto loop = take_loop(row, ids);
    if (!loop) return false;
    if (!row.exhausted()) loop->support = take_support(row);  // since version 4
    if (!row.exhausted()) return false;
    loop->stage = LoopStage::kAccepted;
    loop->corrected = true;
    map.loop_closures.push_back(*loop);
    return true;
  });
}

/// Whether a loop of this stage is no edge, but was decided on or waits for a decision.
bool is_no_edge(LoopStage stage) {
  return stage == LoopStage::kProvisional || stage == LoopStage::kRejected || stage == LoopStage::kWithdrawn;
}

void read_other_loops(const DatabaseReader& file, const Renumbered& ids, MapData& map) {
  file.read(tables::kOtherLoop, [&](int64_t, const Row& cells) {
    RowReader row(cells);
    auto loop = take_loop(row, ids);
    if (!loop) return false;
    loop->support = take_support(row);
    loop->evidence.scale.factor = row.take_in(0.0, kMaxScale);
    loop->evidence.scale.sigma = row.take_in(0.0, kUnconstrained);
    const auto stage = value_named<LoopStage>(row.take<std::string>());
    const auto reason = value_named<LoopReason>(row.take<std::string>());
    if (!row.exhausted() || !stage || !is_no_edge(*stage) || !reason) return false;
    loop->stage = *stage;
    loop->reason = *reason;
    map.other_loops.push_back(*loop);
    return true;
  });
}

/// Sets outcome and method from the numbers in the file.
void set_status(FrameRecord& frame, int64_t status, int64_t unmeasured) {
  constexpr int64_t kTracked = 0, kDense = 1, kPredicted = 2;
  if (status != kTracked && status != kDense) return;
  frame.outcome = TrackingOutcome::kTracked;
  if (status == kDense) frame.method = TrackingMethod::kDense;
  if (unmeasured != 0)
    frame.method = unmeasured == kPredicted ? TrackingMethod::kPredicted : TrackingMethod::kRepeat;
}

std::vector<FrameRecord> read_frames(const DatabaseReader& file, const Renumbered& ids) {
  std::vector<FrameRecord> frames;
  file.read(tables::kFrame, [&](int64_t, const Row& cells) {
    RowReader row(cells);
    FrameRecord frame;
    frame.id = FrameId{take_index(row, kMaxFrames)};
    frame.stamp_ns = take_stamp(row);
    const int64_t status = row.take_in<int64_t>(0, kMaxStatus);
    frame.reference = new_id(ids, take_keyframe(row));
    frame.keyframe = new_id(ids, take_keyframe(row));
    set_status(frame, status, row.take<int64_t>());
    frame.T_reference_camera = take_pose(row);
    if (!row.exhausted())  // not in version 1
      frame.depth_stamp_difference_s = static_cast<float>(row.take_in(-kMaxLagS, kMaxLagS));
    if (!row.exhausted()) {  // not in versions 1 and 2
      const auto cause = doubt_cause(row.take<int64_t>());
      if (!cause) return false;
      if (*cause != DoubtCause::kNone) doubt(frame, *cause);
    }
    if (!row.exhausted() || (!frames.empty() && frame.id <= frames.back().id)) return false;
    frames.push_back(frame);
    return true;
  });
  return frames;
}

/// Number of rows that the file once had beyond `found`.
size_t missing(const std::map<std::string, Cell>& about, const char* table, size_t found) {
  const auto count = about.find(table);
  if (count == about.end() || !std::holds_alternative<int64_t>(count->second)) return 0;
  const int64_t written = std::get<int64_t>(count->second);
  if (written < 0 || written > kMaxRows) return 0;
  return static_cast<size_t>(written) > found ? static_cast<size_t>(written) - found : 0;
}

}  // namespace

std::string describe(const MapDamage& damage) {
  std::vector<std::string> lost;
  const auto add = [&](size_t count, const char* what) {
    if (count > 0) lost.push_back(fmt::format("{} {}", count, what));
  };
  add(damage.keyframes, "keyframes");
  add(damage.landmarks, "landmarks");
  add(damage.loops, "loops");
  add(damage.frames, "frames");
  add(damage.images, "images");
  if (damage.settings) lost.emplace_back("settings");
  return fmt::format("{}", fmt::join(lost, ", "));
}

MapReader::MapReader(std::filesystem::path path) : path_(path), database_(std::move(path), tables::kKind) {}

std::pair<SavedMap, MapDamage> MapReader::read() const {
  SavedMap saved;
  MapDamage damage;
  const auto about = read_about(database_);
  damage.settings = !read_settings(database_, saved) || about.empty();
  const auto camera = camera_from(read_camera(database_));
  if (!camera) {
    throw InputError(
        fmt::format("{}: damaged: the camera could not be read; create the map again", path_.string()));
  }
  saved.camera = *camera;
  const Renumbered ids = take_keyframes(read_keyframes(database_), saved.map);
  if (ids.empty() && missing(about, tables::kKeyframe, 0) > 0) {
    throw InputError(
        fmt::format("{}: damaged: no keyframe could be read; create the map again", path_.string()));
  }
  const size_t landmarks = read_landmarks(database_, ids, saved.map);
  read_loop_closures(database_, ids, saved.map);
  read_other_loops(database_, ids, saved.map);
  saved.frames = read_frames(database_, ids);
  if (const auto program = about.find("program"); program != about.end()) {
    if (const auto* text = std::get_if<std::string>(&program->second)) saved.program = *text;
  }
  if (const auto components = about.find("components"); components != about.end()) {
    if (const auto* n = std::get_if<int64_t>(&components->second); n != nullptr && *n <= kMaxKeyframes)
      saved.map.component_count =
          std::max(saved.map.component_count, static_cast<uint32_t>(std::max<int64_t>(*n, 0)));
  }
  damage.keyframes = missing(about, tables::kKeyframe, ids.size());
  damage.landmarks = missing(about, tables::kLandmark, landmarks);
  damage.loops = missing(about, tables::kLoopEdge, saved.map.loop_closures.size()) +
                 missing(about, tables::kOtherLoop, saved.map.other_loops.size());
  damage.frames = missing(about, tables::kFrame, saved.frames.size());
  return {std::move(saved), damage};
}

size_t MapReader::read_images(const std::function<void(SavedImages)>& take) const {
  size_t count = 0;
  const auto camera = camera_from(read_camera(database_));
  database_.read(tables::kImage, [&](int64_t, const Row& cells) {
    RowReader row(cells);
    SavedImages saved;
    saved.frame = FrameId{take_index(row, kMaxFrames)};
    saved.images.rows = static_cast<int>(row.take_in<int64_t>(1, kMaxSide_px));
    saved.images.cols = static_cast<int>(row.take_in<int64_t>(1, kMaxSide_px));
    const auto color = row.take<Blob>().bytes, depth = row.take<Blob>().bytes;
    if (!row.exhausted() || !camera) return false;
    saved.images.color.assign(color.begin(), color.end());
    saved.images.depth.assign(depth.begin(), depth.end());
    const bool fits = saved.images.rows == camera->color.height && saved.images.cols == camera->color.width;
    if (!fits || !is_decodable(saved.images)) return false;
    take(std::move(saved));
    ++count;
    return true;
  });
  return missing(read_about(database_), tables::kImage, count);
}

}  // namespace kinloop
