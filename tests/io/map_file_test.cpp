#include "kinloop/io/map_file/map_file.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <sqlite3.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/io/map_file/feature_serialization.hpp"
#include "kinloop/io/map_file/map_tables.hpp"
#include "tests/io/sample_map.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

using test::kImages;
using test::kKeyframes;
using test::kKeypoints;
using test::some_images;
using test::some_saved_map;

void write_some_map(const std::filesystem::path& path) {
  write_map(path, some_saved_map(), kImages, some_images);
}

TEST(MapFile, RoundTripIsBitExact) {
  const test::TempFolder folder;
  const auto a = folder.path() / "a ?#%.kinmap", b = folder.path() / "b.kinmap";
  write_some_map(a);
  const MapReader reader(a);
  const auto [again, damage] = reader.read();
  EXPECT_FALSE(damage.any()) << describe(damage);
  std::vector<SavedImages> images;
  EXPECT_EQ(reader.read_images([&](SavedImages image) { images.push_back(std::move(image)); }), 0U);
  ASSERT_EQ(images.size(), kImages);

  const SavedMap saved = some_saved_map();
  EXPECT_EQ(again.camera.T_color_depth.rotation.coeffs(), saved.camera.T_color_depth.rotation.coeffs());
  EXPECT_EQ(again.camera.color, saved.camera.color);
  EXPECT_EQ(again.camera.depth, saved.camera.depth);
  EXPECT_EQ(again.camera.rolling_shutter_s, saved.camera.rolling_shutter_s);
  EXPECT_EQ(again.camera.sensor.model, DepthSensorModel::kIphone);
  EXPECT_EQ(again.camera.sensor.origin, SensorOrigin::kSource);
  EXPECT_EQ(again.sessions[0].input, saved.sessions[0].input);
  EXPECT_EQ(again.map.keyframes[3].T_world_camera.matrix(), saved.map.keyframes[3].T_world_camera.matrix());
  EXPECT_EQ(again.map.keyframes[3].features->depth_stamp_difference_s,
            saved.map.keyframes[3].features->depth_stamp_difference_s);
  EXPECT_EQ(again.frames[5].depth_stamp_difference_s, saved.frames[5].depth_stamp_difference_s);
  EXPECT_EQ(again.frames[1].method, TrackingMethod::kRepeat);
  EXPECT_EQ(again.frames[5].method, TrackingMethod::kPredicted);
  EXPECT_EQ(again.frames[1].trust.cause, DoubtCause::kNone);
  EXPECT_EQ(again.frames[2].trust.cause, DoubtCause::kPlace);
  EXPECT_EQ(again.map.loop_closures[0].information, saved.map.loop_closures[0].information);
  ASSERT_EQ(again.map.other_loops.size(), 2U);
  const LoopClosure& rejected = again.map.other_loops[0];
  EXPECT_EQ(rejected.ends(), (LoopEnds{KeyframeId{2}, KeyframeId{8}}));
  EXPECT_EQ(rejected.stage, LoopStage::kRejected);
  EXPECT_EQ(rejected.reason, LoopReason::kScale);
  EXPECT_EQ(rejected.support, 3);
  EXPECT_EQ(rejected.evidence.scale.factor, 0.93);
  EXPECT_EQ(again.map.other_loops[1].evidence.scale.sigma, std::numeric_limits<double>::infinity());

  // Everything else: saved again, the file is identical byte for byte.
  write_map(b, again, images.size(), [&](size_t i) { return images[i]; });
  EXPECT_TRUE(read_file(a) == read_file(b));
}

/// Writes what an earlier version of the format held: 1 no stamps of depth, 1 and 2 no marks of doubt, 1 to 3
/// no visits of keyframes and no support of loops. None of them had loops that are no edges.
void write_earlier_version(const std::filesystem::path& from, int32_t version,
                           const std::filesystem::path& to) {
  namespace tables = map_tables;
  const DatabaseReader reader(from, tables::kKind);
  DatabaseWriter writer(to, {tables::kKind.application, version});
  for (const char* table :
       {tables::kAbout, tables::kSession, tables::kOption, tables::kCamera, tables::kSensor,
        tables::kKeyframe, tables::kLoopEdge, tables::kLandmark, tables::kFrame, tables::kImage}) {
    bool created = false;
    reader.read(table, [&](int64_t id, Row row) {
      if (table == tables::kAbout && std::get<std::string>(row[0]) == tables::kOtherLoop) return true;
      if (table == tables::kFrame && version < 3) row.resize(row.size() - (version == 1 ? 2 : 1));
      if (table == tables::kKeyframe || table == tables::kLoopEdge) row.pop_back();
      if (table == tables::kKeyframe && version == 1) {
        std::string& features = std::get<Blob>(row.back()).bytes;
        features.resize(features.size() - sizeof(float));
      }
      std::vector<std::string> columns;
      for (size_t i = 0; i < row.size(); ++i) columns.push_back("c" + std::to_string(i));
      if (!std::exchange(created, true)) writer.create(table, columns);
      writer.insert(table, id, row);
      return true;
    });
  }
  writer.commit();
}

TEST(MapFile, FilesOfVersion1AreReadWithoutStampsOfDepth) {
  const test::TempFolder folder;
  write_some_map(folder.path() / "new.kinmap");
  write_earlier_version(folder.path() / "new.kinmap", 1, folder.path() / "old.kinmap");
  const auto [old, damage] = MapReader(folder.path() / "old.kinmap").read();
  EXPECT_FALSE(damage.any()) << describe(damage);
  const SavedMap saved = some_saved_map();
  ASSERT_EQ(old.map.keyframes.size(), saved.map.keyframes.size());
  ASSERT_EQ(old.frames.size(), saved.frames.size());
  EXPECT_EQ(old.map.keyframes[3].features->sigmas_px, saved.map.keyframes[3].features->sigmas_px);
  EXPECT_EQ(old.frames[5].stamp_ns, saved.frames[5].stamp_ns);
  for (const Keyframe& keyframe : old.map.keyframes)
    EXPECT_EQ(keyframe.features->depth_stamp_difference_s, 0);
  for (const FrameRecord& frame : old.frames) EXPECT_EQ(frame.depth_stamp_difference_s, 0);
}

TEST(MapFile, FilesOfVersion2AreReadWithoutMarksOfDoubt) {
  const test::TempFolder folder;
  write_some_map(folder.path() / "new.kinmap");
  write_earlier_version(folder.path() / "new.kinmap", 2, folder.path() / "old.kinmap");
  const auto [old, damage] = MapReader(folder.path() / "old.kinmap").read();
  EXPECT_FALSE(damage.any()) << describe(damage);
  const SavedMap saved = some_saved_map();
  ASSERT_EQ(old.frames.size(), saved.frames.size());
  EXPECT_EQ(old.frames[5].depth_stamp_difference_s, saved.frames[5].depth_stamp_difference_s);
  for (const FrameRecord& frame : old.frames) EXPECT_FALSE(frame.is_doubtful());
}

TEST(MapFile, FilesOfVersion3AreReadWithComponentsAsVisits) {
  const test::TempFolder folder;
  SavedMap saved = some_saved_map();
  ASSERT_EQ(saved.map.keyframes[8].visit, 1U);
  saved.map.keyframes[8].component = 0;  // as if joined
  saved.map.loop_closures[0].support = 4;
  write_map(folder.path() / "new.kinmap", saved, 0, {});
  write_earlier_version(folder.path() / "new.kinmap", 3, folder.path() / "old.kinmap");
  const auto [now, no_damage] = MapReader(folder.path() / "new.kinmap").read();
  const auto [old, damage] = MapReader(folder.path() / "old.kinmap").read();
  EXPECT_FALSE(no_damage.any()) << describe(no_damage);
  EXPECT_FALSE(damage.any()) << describe(damage);
  EXPECT_EQ(now.map.keyframes[8].visit, 1U);
  EXPECT_EQ(old.map.keyframes[8].visit, 0U);
  EXPECT_EQ(old.frames[2].is_doubtful(), saved.frames[2].is_doubtful());
  for (const auto& [map, support] : {std::pair(&now.map, 4), std::pair(&old.map, 1)}) {
    ASSERT_EQ(map->loop_closures.size(), 1U);
    EXPECT_EQ(map->loop_closures[0].support, support);
    EXPECT_TRUE(map->loop_closures[0].corrected);
  }
  EXPECT_EQ(now.map.other_loops.size(), 2U);
  EXPECT_EQ(old.map.other_loops.size(), 0U);
}

/// Replaces a table by a view.
void put_view(const std::filesystem::path& map, const std::string& table, const std::string& select) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(map.c_str(), &database), SQLITE_OK);
  const std::string sql = "DROP TABLE " + table + "; CREATE VIEW " + table + " AS " + select;
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
}

TEST(MapFile, AReadoutTimeThatIsNotKnownStaysUnknown) {
  const test::TempFolder folder;
  SavedMap saved = some_saved_map();
  saved.camera.rolling_shutter_s.reset();
  write_map(folder.path() / "a.kinmap", saved, kImages, some_images);
  EXPECT_FALSE(MapReader(folder.path() / "a.kinmap").read().first.camera.rolling_shutter_s);
}

TEST(MapFile, AViewIsNotReadAsATable) {
  const test::TempFolder folder;
  const auto path = folder.path() / "map.kinmap";
  for (const char* endless :
       {"WITH RECURSIVE r(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM r) SELECT id, 0 AS checksum FROM r",
        "SELECT 1 AS id, zeroblob(900000000) AS a, 0 AS checksum"}) {
    write_some_map(path);
    put_view(path, map_tables::kLandmark, endless);
    const auto damage = MapReader(path).read().second;
    EXPECT_GT(damage.landmarks, 0U);
    EXPECT_EQ(damage.keyframes, 0U);
  }
}

TEST(MapFile, APathMayBeginWithTwoSlashes) {
  const test::TempFolder folder;
  write_some_map(folder.path() / "map.kinmap");
  EXPECT_FALSE(MapReader("/" + (folder.path() / "map.kinmap").string()).read().second.any());
}

TEST(MapFile, AFormatBelowOneIsDamageNotANewerFormat) {
  const test::TempFolder folder;
  const auto path = folder.path() / "map.kinmap";
  { DatabaseWriter(path, {map_tables::kKind.application, 0}).commit(); }
  EXPECT_THAT(test::input_error([&] { const MapReader reader(path); }), HasSubstr("has format 0"));
}

TEST(MapFile, LeavesTheOldFileUntilTheNewOneIsWhole) {
  const test::TempFolder folder;
  const auto path = folder.path() / "map.kinmap";
  write_some_map(path);
  const std::string before = read_file(path);
  const auto broken = [](size_t index) -> SavedImages {
    if (index == 2) throw InputError("the camera is on fire");
    return some_images(index);
  };
  EXPECT_THROW(write_map(path, some_saved_map(), kImages, broken), InputError);
  EXPECT_TRUE(read_file(path) == before);
  const std::filesystem::directory_iterator files(folder.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1) << "only the map";
}

TEST(MapFile, SaysWhatIsWrongWithAFileThatIsNone) {
  const test::TempFolder folder;
  const auto message = [&](const std::filesystem::path& path) {
    return test::input_error([&] { static_cast<void>(MapReader(path).read()); });
  };
  EXPECT_THAT(message(folder.path() / "absent"), HasSubstr("no such file"));
  EXPECT_THAT(message(folder.path()), HasSubstr("no such file"));
  EXPECT_THAT(message(folder.write("empty", "")), HasSubstr("not a kinloop map"));
  EXPECT_THAT(message(folder.write("text", std::string(5000, 'x'))), HasSubstr("not a kinloop map"));
  EXPECT_THAT(test::input_error([&] { write_some_map(folder.path() / "no" / "such.kinmap"); }),
              HasSubstr("cannot be written"));
  write_some_map(folder.path() / "newer");
  std::string bytes = read_file(folder.path() / "newer");
  bytes[63] = 9;  // the user version of the SQLite header, high byte first
  EXPECT_THAT(message(folder.write("newer", bytes)), HasSubstr("use a newer kinloop"));
}

/// The remaining map is consistent and reports its losses; or there is a clear error.
void expect_sound(const std::filesystem::path& path) {
  try {
    const MapReader reader(path);
    auto [saved, damage] = reader.read();
    const size_t read = saved.map.keyframes.size();
    for (const Keyframe& keyframe : saved.map.keyframes) ASSERT_EQ(keyframe.features->size(), kKeypoints);
    EXPECT_EQ(read + damage.keyframes, kKeyframes);
    Map map;
    map.append(std::move(saved.map));
    map.check_invariants();
    reader.read_images([](const SavedImages&) {});
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), StartsWith(path.string()));
  }
}

TEST(MapFile, TruncationLosesOnlyTheEnd) {
  const test::TempFolder folder;
  const auto path = folder.path() / "map.kinmap";
  write_some_map(path);
  const std::string bytes = read_file(path);
  // The images are the last third of this file and more.
  const auto cut = folder.write("cut", bytes.substr(0, bytes.size() * 2 / 3));
  const MapReader reader(cut);
  const auto [saved, damage] = reader.read();
  EXPECT_EQ(saved.map.keyframes.size(), kKeyframes);
  EXPECT_EQ(damage.keyframes + damage.landmarks + damage.frames, 0U);
  size_t whole = 0;
  const size_t lost = reader.read_images([&](const SavedImages& saved_images) {
    EXPECT_EQ(saved_images.images, some_images(whole).images);
    ++whole;
  });
  EXPECT_EQ(whole + lost, kImages);
  EXPECT_GT(lost, 0U);
  EXPECT_GT(whole, 0U);
}

TEST(MapFile, ALostKeyframeLosesOnlyItsObservations) {
  const test::TempFolder folder;
  const auto path = folder.path() / "map.kinmap";
  write_some_map(path);
  std::string bytes = read_file(path);
  const std::string features = serialize_features(*some_saved_map().map.keyframes[6].features);
  const size_t at = bytes.find(features.substr(0, 64));
  ASSERT_NE(at, std::string::npos);
  bytes[at + 20] = static_cast<char>(bytes[at + 20] ^ 1);
  const auto [saved, damage] = MapReader(folder.write("map.kinmap", bytes)).read();
  EXPECT_EQ(damage.keyframes, 1U);
  EXPECT_EQ(damage.landmarks, kKeypoints);  // all landmarks anchored in it
  ASSERT_EQ(saved.map.keyframes.size(), kKeyframes - 1);
  EXPECT_TRUE(saved.map.keyframes[6].begins_component);  // in place of the lost one
  EXPECT_EQ(saved.map.loop_closures.size(), 1U);
}

TEST(MapFile, NoTruncationCrashes) {
  const test::TempFolder folder;
  const auto path = folder.path() / "map.kinmap";
  write_some_map(path);
  const std::string bytes = read_file(path);
  Random random(11);
  for (int i = 0; i < 1000; ++i) {
    const auto length = static_cast<size_t>(random.uniform(0, static_cast<double>(bytes.size())));
    expect_sound(folder.write("cut", bytes.substr(0, length)));
  }
}

TEST(MapFile, NoFlippedBytesCrash) {
  const test::TempFolder folder;
  const auto path = folder.path() / "map.kinmap";
  write_some_map(path);
  const std::string bytes = read_file(path);
  Random random(12);
  for (int i = 0; i < 1000; ++i) {
    std::string flipped = bytes;
    // Half of the time near the beginning, which holds the structure of the file.
    const double reach = i % 2 == 0 ? 40000 : static_cast<double>(bytes.size());
    const int count = 1 + i % 10;
    for (int k = 0; k < count; ++k) {
      flipped[static_cast<size_t>(random.uniform(0, reach))] = static_cast<char>(random.index(256));
    }
    expect_sound(folder.write("flipped", flipped));
  }
}

}  // namespace
}  // namespace kinloop
