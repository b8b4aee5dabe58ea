// The page that holds a run: what is in it, and how large it may become.

#include "viewer/saved/shared_page.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <libdeflate.h>

#include "kinloop/core/time.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "viewer/server/viewer_page.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;

constexpr std::string_view kSlot = "<script type=\"application/gzip\" id=\"recording\">";

/// A cube of random points.
ColoredCloud cube(size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> metres(-20, 20);
  std::uniform_int_distribution<int> shade(0, 255);
  ColoredCloud cloud;
  for (size_t i = 0; i < count; ++i) {
    cloud.points.emplace_back(metres(random), metres(random), metres(random));
    cloud.colors.push_back({static_cast<uint8_t>(shade(random)), 100, 50});
  }
  return cloud;
}

SavedRun small_run(size_t points) {
  SavedRun run;
  run.name = "room </script>";
  run.cloud = cube(points);
  run.path = run.keyframes = {{kNsPerSecond, {}}, {2 * kNsPerSecond, {}}};
  return run;
}

/// `count` images of incompressible bytes.
std::vector<KeyframeImage> images(uint32_t count, size_t bytes) {
  std::mt19937 random(2);
  std::vector<KeyframeImage> images;
  for (uint32_t i = 0; i < count; ++i) {
    std::vector<uint8_t> jpeg(bytes);
    std::generate(jpeg.begin(), jpeg.end(), [&] { return static_cast<uint8_t>(random()); });
    images.push_back({i, std::move(jpeg)});
  }
  return images;
}

std::string from_base64(std::string_view text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  uint32_t bits = 0;
  int count = 0;
  for (const char digit : text.substr(0, text.find('='))) {
    bits = bits << 6 | static_cast<uint32_t>(digits.find(digit));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> count & 0xFF));
  }
  return bytes;
}

std::string gunzipped(const std::string& gzip) {
  uint32_t size = 0;  // a gzip archive ends with it
  std::memcpy(&size, gzip.data() + gzip.size() - sizeof size, sizeof size);
  std::string bytes(size, '\0');
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  EXPECT_EQ(libdeflate_gzip_decompress(decompressor.get(), gzip.data(), gzip.size(), bytes.data(),
                                       bytes.size(), nullptr),
            LIBDEFLATE_SUCCESS);
  return bytes;
}

using Parts = std::map<std::pair<PartKind, uint32_t>, std::string>;

/// The bodies of the parts in a page.
Parts parts_in(const std::string& html) {
  const size_t begin = html.find(kSlot) + kSlot.size();
  const std::string messages =
      gunzipped(from_base64(std::string_view(html).substr(begin, html.find('<', begin) - begin)));
  Parts parts;
  for (size_t at = 0; at < messages.size();) {
    uint32_t kind = 0, index = 0;
    double body_bytes = 0;
    std::memcpy(&kind, &messages[at], sizeof kind);
    std::memcpy(&index, &messages[at + 4], sizeof index);
    std::memcpy(&body_bytes, &messages[at + 16], sizeof body_bytes);
    const auto size = static_cast<size_t>(body_bytes);
    parts[{static_cast<PartKind>(kind), index}] = messages.substr(at + kHeaderBytes, size);
    at += kHeaderBytes + size;
  }
  return parts;
}

size_t points_in(const Parts& parts) {
  size_t points = 0;
  for (const auto& [part, body] : parts) {
    uint32_t count = 0;
    if (part.first == PartKind::kCloud) std::memcpy(&count, &body[4], sizeof count);
    points += count;
  }
  return points;
}

class SharedPageTest : public testing::Test {
 protected:
  void SetUp() override {
    if (viewer_page().find(kSlot) == std::string_view::npos)
      GTEST_SKIP() << "the pages are off in this build";
  }
};

TEST_F(SharedPageTest, HoldsEveryPartThatAServerWouldSend) {
  const SavedRun run = small_run(1000);
  const auto page = make_shared_page(run, images(3, 100), {});
  EXPECT_EQ(page.points, 1000U);
  EXPECT_EQ(page.images, 3U);
  const Parts parts = parts_in(page.html);
  Scene scene("shared");
  show_saved_run(scene, run);
  size_t expected = 3;  // images
  for (auto part = scene.next_after(0); part; part = scene.next_after(part->version)) {
    ++expected;
    if (part->kind == PartKind::kCloud) continue;  // its points may come in another order
    const auto found = parts.find({part->kind, part->index});
    ASSERT_NE(found, parts.end()) << static_cast<int>(part->kind);
    EXPECT_EQ(found->second, std::string(part->body->begin(), part->body->end()));
  }
  EXPECT_EQ(parts.size(), expected);
  EXPECT_EQ(points_in(parts), 1000U);
  EXPECT_EQ(parts.at({PartKind::kKeyframeImage, 2}).size(), 100U);
}

TEST_F(SharedPageTest, IsTheViewersPageThatMayLoadNothing) {
  const std::string html = make_shared_page(small_run(10), {}, {}).html;
  std::string page(html);
  const size_t policy = page.find("<meta http-equiv=\"Content-Security-Policy\"");
  ASSERT_NE(policy, std::string::npos);
  EXPECT_THAT(page.substr(policy, 100), HasSubstr("default-src 'none'"));
  EXPECT_LT(policy, page.find("<script")) << "before anything could be loaded";
  page.erase(policy, page.find('\n', policy) + 1 - policy);
  const size_t data = page.find(kSlot) + kSlot.size();
  EXPECT_EQ(page.erase(data, page.find('<', data) - data), viewer_page());
}

TEST_F(SharedPageTest, NamesNoFileOfThisMachine) {
  SavedRun run = small_run(10);
  run.loops.emplace_back();
  run.map_file = "/home/me/map.kinmap";
  const Parts parts = parts_in(make_shared_page(run, {}, {}).html);
  EXPECT_EQ(parts.at({PartKind::kLoopTable, 0}).find("/home/me"), std::string::npos);
}

TEST_F(SharedPageTest, ThinsTheCloudEvenlyToTheLimit) {
  const size_t limit = viewer_page().size() + 1'000'000;
  const auto page = make_shared_page(small_run(300'000), {}, {.bytes = limit});
  EXPECT_LE(page.html.size(), limit);
  EXPECT_GT(page.html.size(), limit - 100'000) << "as many points as fit";
  EXPECT_LT(page.points, 300'000U);
  const Parts parts = parts_in(page.html);
  EXPECT_EQ(points_in(parts), page.points);
  float unit_m = 0;
  const std::string& piece = parts.at({PartKind::kCloud, 0});
  std::memcpy(&unit_m, &piece[8], sizeof unit_m);
  EXPECT_NEAR(unit_m * 65534, 40, 0.1) << "points come from the whole cube";
}

TEST_F(SharedPageTest, HoldsAtMostThePointsThatAreAskedFor) {
  const auto page = make_shared_page(small_run(1000), {}, {.points = 10});
  EXPECT_EQ(page.points, 10U);
  EXPECT_EQ(points_in(parts_in(page.html)), 10U);
}

TEST_F(SharedPageTest, LeavesMostOfThePageToTheMap) {
  const size_t limit = viewer_page().size() + 1'000'000;
  const auto page = make_shared_page(small_run(300'000), images(100, 10'000), {.bytes = limit});
  EXPECT_LE(page.html.size(), limit);
  EXPECT_GT(page.images, 5U);
  EXPECT_LE(page.images * 10'000 * 4 / 3, 1'000'000 / 4) << "a quarter of the room, in base64";
  EXPECT_GT(page.points, 10'000U);
  const Parts parts = parts_in(page.html);
  uint32_t last = 0;
  for (const auto& [part, body] : parts)
    if (part.first == PartKind::kKeyframeImage) last = part.second;
  EXPECT_GT(last, 80U) << "images come from the whole run";
}

TEST_F(SharedPageTest, FitsManyImagesIntoTheSmallestPage) {
  const size_t limit = page_bytes("--max-size", kSmallestPageMb);
  const auto page = make_shared_page(small_run(300'000), images(200, 10'000), {.bytes = limit});
  EXPECT_LE(page.html.size(), limit);
  EXPECT_GT(page.images, 0U);
  EXPECT_GT(page.points, 1000U);
}

TEST_F(SharedPageTest, LeavesOutTheImagesWhereTheRestJustFits) {
  const SavedRun run = small_run(1000);
  const size_t rest = make_shared_page(run, {}, {.points = 0}).html.size();
  const auto page = make_shared_page(run, images(3, 10'000), {.bytes = rest + 1000});
  EXPECT_LE(page.html.size(), rest + 1000);
  EXPECT_EQ(page.images, 0U);
}

TEST_F(SharedPageTest, RefusesAMeshThatDoesNotFitAndSaysWhatHelps) {
  SavedRun run = small_run(10);
  run.mesh.points = cube(100'000).points;
  run.mesh.triangles = {{0, 1, 2}};
  const auto error = test::input_error([&] { make_shared_page(run, {}, {.bytes = 1'500'000}); });
  EXPECT_THAT(error, HasSubstr("of at most 1.5 MB"));
  EXPECT_THAT(error, HasSubstr("--triangles"));
}

TEST_F(SharedPageTest, OfAnEmptyRunIsAPage) {
  const auto page = make_shared_page({}, {}, {});
  EXPECT_EQ(page.points, 0U);
  EXPECT_EQ(parts_in(page.html).count({PartKind::kHello, 0}), 1U);
}

TEST(PageBytes, AreThoseOfASizeWithinTheRange) {
  EXPECT_EQ(page_bytes("max", 1), 1'000'000U);
  EXPECT_EQ(page_bytes("max", 100), 100'000'000U);
  for (const double size_mb : {0.0, 0.9, 100.1, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(test::usage_error([&] { page_bytes("max", size_mb); }),
              fmt::format("max is {}; expected 1 to 100", size_mb));
}

TEST(SelectContents, SaysWhatHelpsARunWithoutAMesh) {
  const test::TempFolder folder;
  const auto error_at = [](const std::filesystem::path& path) {
    SavedRun run = small_run(1);
    run.name = "Python";
    return test::input_error([&] { select_contents(run, true, false, path); });
  };
  EXPECT_THAT(error_at(folder.path()), HasSubstr("kinloop mesh " + folder.path().string() + " -o "));
  EXPECT_EQ(error_at("room.ply"),
            "room.ply: has no mesh; share the folder of a run with mesh.ply, or a mesh file");
  EXPECT_THAT(error_at(""), testing::StartsWith("Python: has no mesh; share the folder"));
}

}  // namespace
}  // namespace kinloop
