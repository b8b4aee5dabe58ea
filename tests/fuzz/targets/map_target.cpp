#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"
#include "kinloop/slam/saved_session.hpp"
#include "kinloop/slam/slam.hpp"
#include "session/store/dense_recorder.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/map_rows.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace kinloop::fuzz {
namespace {

void expect_possible_damage(const MapDamage& damage) {
  constexpr size_t kMost = size_t{1} << 32;
  for (const size_t lost : {damage.keyframes, damage.landmarks, damage.loops, damage.frames, damage.images})
    require(lost <= kMost, "more is lost than there can be");
  static_cast<void>(describe(damage));
}

/// What a run does with a loaded map before its first frame.
void continue_map(const SavedMap& saved) {
  static const Vocabulary kVocabulary = load_default_vocabulary();
  SlamOptions options;
  options.executor.mode = ExecutorMode::kInline;
  Slam slam(saved.camera, options, kVocabulary);
  slam.add_map(saved);
  slam.map().check_invariants();
  for (const Keyframe& keyframe : slam.map().keyframes())
    static_cast<void>(make_local_map(slam.map(), keyframe.id, options.local_map));
}

/// What the commands on maps do with the images.
void use_images(const MapReader& reader, const SavedMap& saved) {
  DenseOptions options;
  options.voxel_m = 0.1;  // coarse, for speed
  DenseRecorder recorder(saved.camera, options);
  MapDamage damage;
  damage.images = reader.read_images([&](const SavedImages& images) { recorder.restore(images); });
  expect_possible_damage(damage);
  Map map;
  map.append(saved.map);
  const FrameLog log = logged_frames(saved, 0, 0);
  const auto views = recorder.views(log, map, 0);
  static_cast<void>(recorder.fuse_views(views, dense_camera(saved.camera, {}), 1, {}));
}

}  // namespace

void read_map_bytes(std::string_view bytes) {
  with_file("map.kinmap", "", [&](const auto& path) {
    accept([&] {
      write_rows(path, rows_of(bytes));
      const MapReader reader(path);
      const auto [saved, damage] = reader.read();
      expect_possible_damage(damage);
      expect_possible(saved.camera);
      use_images(reader, saved);
      continue_map(saved);
    });
  });
}

}  // namespace kinloop::fuzz
