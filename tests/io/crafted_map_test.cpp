// Map files with right checksums and wrong values.

#include <functional>

#include <gmock/gmock.h>

#include "kinloop/io/map_file/feature_serialization.hpp"
#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/io/map_file/map_tables.hpp"
#include "kinloop/map/local_map.hpp"
#include "tests/io/sample_map.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

namespace tables = map_tables;
using test::kImages;
using testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Changes the id or the cells of a row.
using Edit = std::function<void(int64_t& id, Row& cells)>;

Edit cell(size_t column, Cell value) {
  return [=](int64_t&, Row& cells) { cells.at(column) = value; };
}

Edit new_id(int64_t value) {
  return [=](int64_t& id, Row&) { id = value; };
}

/// Changes the keypoints of a keyframe.
Edit features(const std::function<void(Features&)>& change) {
  return [=](int64_t&, Row& cells) {
    auto& blob = std::get<Blob>(cells[cells.size() - 2]);
    Features changed = *deserialize_features(blob.bytes);
    changed.descriptors = changed.descriptors.clone();
    change(changed);
    blob.bytes = serialize_features(changed);
  };
}

class CraftedMapTest : public testing::Test {
 protected:
  CraftedMapTest() { write_map(original, test::some_saved_map(), kImages, test::some_images); }

  /// The map with one changed row, and right checksums.
  [[nodiscard]] MapReader with(const char* table, int64_t row, const Edit& edit) const {
    const DatabaseReader reader(original, tables::kKind);
    const auto path = folder.path() / "crafted.kinmap";
    DatabaseWriter writer(path, tables::kKind);
    for (const char* name : {tables::kAbout, tables::kSession, tables::kOption, tables::kCamera,
                             tables::kSensor, tables::kKeyframe, tables::kLoopEdge, tables::kOtherLoop,
                             tables::kLandmark, tables::kFrame, tables::kImage}) {
      copy_table(reader, name, name == table ? row : -1, edit, writer);
    }
    writer.commit();
    return MapReader(path);
  }

  static void copy_table(const DatabaseReader& reader, const char* name, int64_t row, const Edit& edit,
                         DatabaseWriter& writer) {
    std::map<int64_t, Row> rows;
    reader.read(name, [&](int64_t id, Row cells) {
      if (id == row) edit(id, cells);
      rows.emplace(id, std::move(cells));
      return true;
    });
    std::vector<std::string> columns;
    for (size_t i = 0; i < rows.begin()->second.size(); ++i) columns.push_back("c" + std::to_string(i));
    writer.create(name, columns);
    for (const auto& [id, cells] : rows) writer.insert(name, id, cells);
  }

  /// The damage, after the map has been used.
  static MapDamage damage_of(const MapReader& reader) {
    auto [saved, damage] = reader.read();
    const cv::Size size(saved.camera.color.width, saved.camera.color.height);
    Map map;
    map.append(std::move(saved.map));
    map.check_invariants();
    for (const Keyframe& keyframe : map.keyframes()) static_cast<void>(make_local_map(map, keyframe.id, {}));
    damage.images = reader.read_images([&](const SavedImages& images) {
      const RgbdImages decoded = decode_images(images.images, {});
      EXPECT_TRUE(decoded.color.size() == size && decoded.depth_m.size() == size);
    });
    return damage;
  }

  const test::TempFolder folder;
  const std::filesystem::path original = folder.path() / "original.kinmap";
};

TEST_F(CraftedMapTest, AnUnchangedCopyIsWhole) {
  const MapDamage damage = damage_of(with(tables::kFrame, 3, [](int64_t&, Row&) {}));
  EXPECT_FALSE(damage.any()) << describe(damage);
}

TEST_F(CraftedMapTest, ALandmarkWithAnImpossibleValueIsLost) {
  const std::vector<Edit> edits = {new_id(-1),
                                   new_id(60'000'000),
                                   new_id(int64_t{1} << 40),
                                   cell(0, int64_t{-1}),
                                   cell(0, int64_t{1} << 33),
                                   cell(0, int64_t{9'999}),
                                   cell(1, kInfinity),
                                   cell(2, 1e300),
                                   cell(4, Blob{"short"})};
  for (size_t i = 0; i < edits.size(); ++i) {
    const MapDamage damage = damage_of(with(tables::kLandmark, 7, edits[i]));
    EXPECT_EQ(describe(damage), "1 landmarks") << i;
  }
}

TEST_F(CraftedMapTest, AKeyframeWithAnImpossibleValueIsLost) {
  const std::vector<Edit> edits = {new_id(-1),
                                   new_id(int64_t{1} << 32),
                                   cell(0, int64_t{-1}),
                                   cell(0, int64_t{1} << 32),
                                   cell(1, std::numeric_limits<int64_t>::min()),
                                   cell(2, int64_t{4'294'967'295}),
                                   cell(2, int64_t{-1}),
                                   cell(2, int64_t{1} << 24),
                                   cell(4, kInfinity),
                                   cell(5, 1e300),
                                   cell(7, 5.0),
                                   cell(10, int64_t{1}),
                                   cell(12, int64_t{-1})};
  for (size_t i = 0; i < edits.size(); ++i)
    EXPECT_EQ(damage_of(with(tables::kKeyframe, 3, edits[i])).keyframes, 1U) << i;
}

TEST_F(CraftedMapTest, AKeyframeWithImpossibleFeaturesIsLost) {
  const std::vector<std::function<void(Features&)>> changes = {
      [](Features& f) { f = Features(); },
      [](Features& f) { f.levels.clear(); },
      [](Features& f) { f.depths_m.clear(); },
      [](Features& f) { f.measured_pixels.clear(); },
      [](Features& f) { f.sigmas_px.pop_back(); },
      [](Features& f) { f.levels[3] = 8; },
      [](Features& f) { f.levels[3] = -1; },
      [](Features& f) { f.level_count = 1 << 30; },
      [](Features& f) { f.scale_factor = std::numeric_limits<double>::quiet_NaN(); },
      [](Features& f) { f.pixels[0].x() = std::numeric_limits<float>::infinity(); },
      [](Features& f) { f.depths_m[0] = -1; },
      [](Features& f) { f.sigmas_px[0] = 0; },
      [](Features& f) { f.depth_stamp_difference_s = 1e30F; },
      [](Features& f) { f.descriptors = cv::Mat(); },
      [](Features& f) { f.descriptors = f.descriptors.colRange(0, 31).clone(); },
      [](Features& f) { f.descriptors = f.descriptors.rowRange(0, 1).clone(); },
      [](Features& f) { f.descriptors.convertTo(f.descriptors, CV_32FC1); },
  };
  for (size_t i = 0; i < changes.size(); ++i)
    EXPECT_EQ(damage_of(with(tables::kKeyframe, 3, features(changes[i]))).keyframes, 1U) << i;
}

TEST_F(CraftedMapTest, ALoopWithAnImpossibleValueIsLost) {
  std::string infinite(36 * sizeof(double), '\0');
  std::memcpy(infinite.data(), &kInfinity, sizeof kInfinity);
  const std::vector<Edit> edits = {cell(0, int64_t{-1}), cell(0, int64_t{4}),    cell(2, -kInfinity),
                                   cell(8, 7.0),         cell(9, Blob{"short"}), cell(9, Blob{infinite}),
                                   cell(10, int64_t{-1})};
  for (size_t i = 0; i < edits.size(); ++i)
    EXPECT_EQ(describe(damage_of(with(tables::kLoopEdge, 0, edits[i]))), "1 loops") << i;
}

TEST_F(CraftedMapTest, ALoopThatIsNoEdgeIsLostWithAnImpossibleValue) {
  const std::vector<Edit> edits = {cell(1, int64_t{99}),          cell(2, kInfinity),
                                   cell(11, int64_t{0}),          cell(12, -1.0),
                                   cell(13, -kInfinity),          cell(14, std::string("accepted")),
                                   cell(14, std::string("none")), cell(15, std::string("because")),
                                   cell(15, int64_t{3})};
  for (size_t i = 0; i < edits.size(); ++i)
    EXPECT_EQ(describe(damage_of(with(tables::kOtherLoop, 1, edits[i]))), "1 loops") << i;
}

TEST_F(CraftedMapTest, AFrameWithAnImpossibleValueIsLost) {
  const std::vector<Edit> edits = {cell(0, int64_t{-1}),      cell(0, int64_t{0}),  cell(0, int64_t{1} << 31),
                                   cell(1, int64_t{1} << 62), cell(2, int64_t{-1}), cell(3, int64_t{1} << 32),
                                   cell(6, kInfinity),        cell(9, 3.0),         cell(13, kInfinity)};
  for (size_t i = 0; i < edits.size(); ++i)
    EXPECT_EQ(describe(damage_of(with(tables::kFrame, 9, edits[i]))), "1 frames") << i;
}

TEST_F(CraftedMapTest, AnImageThatDoesNotFitIsLost) {
  const SavedImages images = test::some_images(1);
  const auto blob = [](const std::vector<uint8_t>& bytes) { return Blob{{bytes.begin(), bytes.end()}}; };
  const auto other =
      encode_images(cv::Mat(60, 80, CV_8UC3, cv::Scalar(1)), cv::Mat(60, 80, CV_32FC1, cv::Scalar(1)), {});
  std::vector<uint8_t> longer = images.images.depth;
  longer.insert(longer.begin(), 40, uint8_t{0xff});
  const std::vector<Edit> edits = {cell(0, int64_t{-1}),
                                   cell(1, int64_t{119}),
                                   cell(2, int64_t{-160}),
                                   cell(2, int64_t{1} << 33),
                                   cell(3, blob(other.encoded.color)),
                                   cell(3, Blob{"\xff\xd8\xff nothing"}),
                                   cell(3, Blob{}),
                                   cell(4, blob(other.encoded.depth)),
                                   cell(4, blob(longer)),
                                   cell(4, Blob{})};
  for (size_t i = 0; i < edits.size(); ++i)
    EXPECT_EQ(describe(damage_of(with(tables::kImage, 1, edits[i]))), "1 images") << i;
}

TEST_F(CraftedMapTest, AJpegThatIsDamagedBehindItsHeaderShowsNothing) {
  SavedImages images = test::some_images(1);
  images.images.color.resize(images.images.color.size() / 2);
  std::fill(images.images.color.begin() + 700, images.images.color.end(), uint8_t{0xff});
  const RgbdImages decoded = decode_images(images.images, {});
  EXPECT_EQ(decoded.color.size(), decoded.depth_m.size());
}

TEST_F(CraftedMapTest, CountsThatCannotBeAreNotBelieved) {
  for (const int64_t count :
       {int64_t{-10}, std::numeric_limits<int64_t>::min(), std::numeric_limits<int64_t>::max()}) {
    for (int64_t row = 1; row <= 6; ++row) {
      const MapReader reader = with(tables::kAbout, row, cell(1, count));
      EXPECT_FALSE(damage_of(reader).any()) << describe(damage_of(reader));
      EXPECT_EQ(reader.read().first.map.component_count, 2U);
    }
  }
  EXPECT_EQ(with(tables::kAbout, 1, cell(1, int64_t{4'294'967'295})).read().first.map.component_count, 2U);
}

TEST_F(CraftedMapTest, AnImpossibleCameraIsAnError) {
  const std::vector<Cell> values = {kInfinity, -kInfinity, 0.0, -1.0, 1e300, int64_t{5}, std::string("640")};
  for (int64_t row = 0; row < 4; ++row) {  // width, height, fx, fy
    for (const Cell& value : values) {
      const MapReader reader = with(tables::kCamera, row, cell(1, value));
      EXPECT_THAT(test::input_error([&] { static_cast<void>(reader.read()); }), HasSubstr("camera"));
      EXPECT_EQ(reader.read_images([](const SavedImages&) { FAIL(); }), kImages);
    }
  }
}

TEST_F(CraftedMapTest, SettingsThatCannotBeAreLeftOut) {
  const auto session = with(tables::kSession, 1, cell(1, int64_t{-1})).read();
  EXPECT_TRUE(session.second.settings);
  EXPECT_EQ(session.first.sessions.size(), 1U);
  const auto sensor = with(tables::kSensor, 0, cell(0, kInfinity)).read();
  EXPECT_TRUE(sensor.second.settings);
  EXPECT_EQ(sensor.first.sensor.size(), 1U);
  const auto option = with(tables::kOption, 0, cell(1, int64_t{1})).read();
  EXPECT_TRUE(option.second.settings);
  EXPECT_EQ(option.first.options.size(), 1U);
}

}  // namespace
}  // namespace kinloop
