// Images without a list of frames: the times in their names, which belong together, and which have no
// partner.

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "drivers/datasets/reading/lists/equal_names.hpp"
#include "drivers/datasets/reading/lists/name_times.hpp"
#include "drivers/datasets/reading/lists/pair_images.hpp"
#include "drivers/datasets/reading/lists/tum_listing.hpp"
#include "kinloop/core/random.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;
using test::input_error;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

constexpr int64_t kStart_s = 1'700'000'000;

/// Times of frames at 15 Hz, in microseconds.
int64_t micros(int i) {
  return kStart_s * 1'000'000 + int64_t{i} * 1'000'000 / 15;
}

using NameOf = std::function<std::string(int64_t us)>;

/// As Python prints a float: the shortest digits, at least one after the point.
std::string printed_by_python(int64_t us) {
  return fmt::format("{}", static_cast<double>(us) * 1e-6 == std::floor(static_cast<double>(us) * 1e-6)
                               ? fmt::format("{}.0", us / 1'000'000)
                               : fmt::format("{}", static_cast<double>(us) / 1e6));
}

struct NameKind {
  const char* name;
  NameOf name_of;
  int64_t step_ns;  ///< to which the names are rounded
};

const std::vector<NameKind>& name_kinds() {
  static const std::vector<NameKind> kKinds = {
      {"python", printed_by_python, 1000},
      {"decimals", [](int64_t us) { return fmt::format("{}.{:06}", us / 1'000'000, us % 1'000'000); }, 1000},
      {"seconds_nanoseconds",
       [](int64_t us) { return fmt::format("{}_{:09}", us / 1'000'000, us % 1'000'000 * 1000); }, 1000},
      {"not padded", [](int64_t us) { return fmt::format("{}_{}", us / 1'000'000, us % 1'000'000 * 1000); },
       1000},
      {"%d.%d", [](int64_t us) { return fmt::format("{}.{}", us / 1'000'000, us % 1'000'000 * 1000); }, 1000},
      {"seconds-microseconds",
       [](int64_t us) { return fmt::format("frame-{}-{:06}", us / 1'000'000, us % 1'000'000); }, 1000},
      {"nanoseconds", [](int64_t us) { return fmt::format("{}", us * 1000); }, 1000},
      {"microseconds", [](int64_t us) { return fmt::format("rgb_{}", us); }, 1000},
      {"milliseconds", [](int64_t us) { return fmt::format("{}", us / 1000); }, 1'000'000},
      {"milliseconds with a fraction",
       [](int64_t us) { return fmt::format("{}.{:03}", us / 1000, us % 1000); }, 1000},
      {"of an ID",
       [](int64_t us) {
         return fmt::format("42444946_{}.{:03}", us / 1'000'000 % 100'000, us / 1000 % 1000);
       },
       1'000'000},
      {"after a number",
       [](int64_t us) { return fmt::format("{:06}_{}.{:06}", us % 977, us / 1'000'000, us % 1'000'000); },
       1000},
      {"before a number", [](int64_t us) { return fmt::format("{}_{:04}", us, us / 66'666 % 1000); }, 1000},
      {"with the size of images", [](int64_t us) { return fmt::format("{}_640x480", us); }, 1000},
      {"dates",
       [](int64_t us) {
         return fmt::format("20231114_2213{:02}_{:06}", 20 + us / 1'000'000 % 30, us % 1'000'000);
       },
       1000},
      {"dates with dashes",
       [](int64_t us) {
         return fmt::format("2023-11-14T22-13-{:02}.{:03}", 20 + us / 1'000'000 % 30, us / 1000 % 1000);
       },
       1'000'000},
      {"uptime in nanoseconds",
       [](int64_t us) { return fmt::format("{}", (us - kStart_s * 1'000'000 + 77) * 1000); }, 1000},
      {"uptime in microseconds",
       [](int64_t us) { return fmt::format("{:012}", us - kStart_s * 1'000'000 + 77); }, 1000},
      {"uptime in milliseconds",
       [](int64_t us) { return fmt::format("{}", (us - kStart_s * 1'000'000) / 1000 + 12'345); }, 1'000'000},
  };
  return kKinds;
}

std::vector<fs::path> files_named(const NameOf& name_of, const char* ending, int count,
                                  const std::vector<int>& missing = {}) {
  std::vector<fs::path> files;
  for (int i = 0; i < count; ++i) {
    if (std::find(missing.begin(), missing.end(), i) == missing.end())
      files.push_back(name_of(micros(i)) + ending);
  }
  return files;
}

TEST(TimesInNames, AreThoseThatWereWritten) {
  for (const NameKind& kind : name_kinds()) {
    SCOPED_TRACE(kind.name);
    const auto files = files_named(kind.name_of, ".png", 40);
    SCOPED_TRACE(files[3].string());
    const auto times = times_in_names(files);
    ASSERT_TRUE(times);
    for (size_t i = 0; i < files.size(); ++i) {
      const int64_t since_first_ns = (micros(static_cast<int>(i)) - micros(0)) * 1000;
      EXPECT_LE(std::abs(times->stamps_ns[i] - times->stamps_ns[0] - since_first_ns), kind.step_ns) << i;
    }
  }
}

TEST(TimesInNames, NumbersOfFramesAreNone) {
  const std::vector<std::vector<const char*>> kinds = {
      {"0.png", "1.png", "2.png"},
      {"0000.png", "0005.png", "0010.png", "0020.png", "0025.png"},
      {"frame-000007.color.png", "frame-000011.color.png", "frame-000021.color.png"},
      {"3.png", "9.png", "14.png", "22.png", "40.png", "47.png"},  // keyframes
      {"a.png", "b.png"},
      {"scene1_0_000000001.png", "scene1_0_000000002.png"},
      {"20230101_0001.png", "20230101_0002.png"},
      {"99999999999999999999999999.png", "99999999999999999999999998.png"},
      {"1700000000.5.png", "1700000000.5.png"},
  };
  for (const auto& kind : kinds) EXPECT_FALSE(times_in_names({kind.begin(), kind.end()})) << kind.front();
}

TEST(EqualNames, DoNotMindWordsZerosAndWhatAllHave) {
  const auto count = [](std::vector<fs::path> color, std::vector<fs::path> depth) {
    return pairs_of_equal_names(color, depth).size();
  };
  EXPECT_EQ(count({"color_0012.png", "color_0013.png"}, {"12_depth.png", "13_depth.png"}), 2U);
  EXPECT_EQ(count({"cam0_rgb_1.png", "cam0_rgb_2.png"}, {"cam1_depth_1.png", "cam1_depth_3.png"}), 1U);
  EXPECT_EQ(count({"1.05.png", "1.5.png"}, {"1.5.png", "1.50.png"}), 1U);
  EXPECT_EQ(count({"0_5.png", "1_5.png"}, {"0_5.png", "1_5.png"}), 2U);
  EXPECT_EQ(count({"a.png"}, {}), 0U);
}

/// "first pair" checks: every frame has two images of the same time.
RecordedSequence paired(const std::vector<fs::path>& color, const std::vector<fs::path>& depth) {
  RecordedSequence sequence;
  pair_images(color, depth, 30, sequence);
  return sequence;
}

TEST(Pairs, OfEqualNamesAreKeptWhereImagesAreMissing) {
  for (const NameKind& kind : name_kinds()) {
    SCOPED_TRACE(kind.name);
    auto color = files_named(kind.name_of, ".jpg", 30, {20}),
         depth = files_named(kind.name_of, ".png", 30, {8});
    std::sort(color.begin(), color.end());  // as a folder lists them, which may not be the order of time
    std::sort(depth.begin(), depth.end());
    const RecordedSequence sequence = paired(color, depth);
    ASSERT_THAT(sequence.frames, SizeIs(28));
    EXPECT_EQ(sequence.pairing.rule, "of equal names");
    EXPECT_EQ(sequence.skipped.size(), 2U);
    EXPECT_EQ(sequence.pairing.color.count, 1U);
    EXPECT_EQ(sequence.pairing.depth.first.filename().string(), kind.name_of(micros(20)) + ".png");
    EXPECT_TRUE(sequence.stamps_measured);
    for (size_t i = 0; i < sequence.frames.size(); ++i) {
      const RecordedFrame& frame = sequence.frames[i];
      EXPECT_EQ(frame.color.file.stem(), frame.depth.file.stem());
      EXPECT_EQ(frame.stamp_ns, frame.depth_stamp_ns);
      if (i > 0) {
        EXPECT_GT(frame.stamp_ns, sequence.frames[i - 1].stamp_ns);
      }
    }
  }
}

TEST(Pairs, AreOfTheNearestTimeWhateverUnitsTheNamesHave) {
  const auto& kinds = name_kinds();
  for (const NameKind& color_kind : kinds) {
    for (const NameKind& depth_kind : kinds) {
      const auto is_unix = [](const NameKind& kind) {
        return !std::string(kind.name).starts_with("uptime") && std::string(kind.name) != "of an ID" &&
               !std::string(kind.name).starts_with("date") &&  // of other clocks
               std::string(kind.name) != "before a number";    // which may be equal
      };
      if (!is_unix(color_kind) || !is_unix(depth_kind)) continue;
      SCOPED_TRACE(fmt::format("colour {}, depth {}", color_kind.name, depth_kind.name));
      const auto later = [&](int64_t us) { return depth_kind.name_of(us + 4'100); };
      const auto color = files_named(color_kind.name_of, ".jpg", 30, {3});
      const auto depth = files_named(later, ".png", 30, {12});
      const RecordedSequence sequence = paired(color, depth);
      ASSERT_THAT(sequence.frames, SizeIs(28));
      EXPECT_EQ(sequence.pairing.rule, nearest_time_rule());
      for (const RecordedFrame& frame : sequence.frames)
        EXPECT_NEAR(1e-6 * static_cast<double>(frame.depth_stamp_ns - frame.stamp_ns), 4.1, 1.01);
    }
  }
}

TEST(Pairs, ColourOfAFasterCameraIsCountedAndNotLost) {
  const auto seconds = [](int64_t us) { return fmt::format("{}.{:06}", us / 1'000'000, us % 1'000'000); };
  auto color = files_named(seconds, ".jpg", 30);
  const auto depth = files_named(seconds, ".png", 30);
  for (int i = 0; i < 30; ++i) color.push_back(seconds(micros(i) + 33'333) + ".jpg");
  const RecordedSequence sequence = paired(color, depth);
  EXPECT_THAT(sequence.frames, SizeIs(30));
  EXPECT_EQ(sequence.skipped.size(), 0U);
  EXPECT_EQ(sequence.pairing.color.count, 30U);
  EXPECT_THAT(unpaired_text(sequence.pairing),
              AllOf(HasSubstr("30 of 60 colour"), HasSubstr("1700000000.033333")));
}

TEST(Pairs, ByOrderAreSaidAndRefusedWhereCountsDiffer) {
  EXPECT_TRUE(paired({"a.png", "b.png"}, {"x.png", "y.png"}).pairing.by_order);
  EXPECT_FALSE(paired({"1.png", "2.png"}, {"1.png", "2.png"}).pairing.by_order);
  EXPECT_THAT(input_error([] { paired({"a.png"}, {"x.png", "y.png"}); }), HasSubstr("associations.txt"));
  // Two clocks: the order is all there is, unless an image is missing.
  const auto unix = [](int64_t us) { return fmt::format("{}", us); };
  const auto uptime = [](int64_t us) { return fmt::format("{}", us - kStart_s * 1'000'000); };
  const RecordedSequence two_clocks = paired(files_named(unix, ".png", 20), files_named(uptime, ".png", 20));
  EXPECT_TRUE(two_clocks.pairing.by_order);
  EXPECT_EQ(two_clocks.frames[7].stamp_ns, two_clocks.frames[7].depth_stamp_ns);
  EXPECT_THAT(
      input_error([&] { paired(files_named(unix, ".png", 20), files_named(uptime, ".png", 20, {3})); }),
      HasSubstr("none of the one is within 0.02 s"));
}

TEST(Pairs, OfAnyNamesAreInOrderOfTimeOrRefused) {
  Random random(17);
  const int count = test::mutations(400);
  int refused = 0;
  for (int i = 0; i < count; ++i) {
    const auto& kinds = name_kinds();
    const auto pick = [&] { return kinds[random.index(static_cast<uint32_t>(kinds.size()))].name_of; };
    auto color = files_named(pick(), ".jpg", 6), depth = files_named(pick(), ".png", 6);
    for (auto* files : {&color, &depth}) {
      for (uint32_t n = random.index(3); n > 0; --n) {
        fs::path& file = (*files)[random.index(6)];
        std::string name = test::mutated(file.string(), random);
        std::erase_if(name, [](char c) { return c == '\0' || c == '/'; });
        file = name;
      }
    }
    if (random.index(2) == 0) color.pop_back();
    try {
      const RecordedSequence sequence = paired(color, depth);
      EXPECT_FALSE(sequence.frames.empty());
      for (size_t f = 1; f < sequence.frames.size(); ++f)
        ASSERT_GT(sequence.frames[f].stamp_ns, sequence.frames[f - 1].stamp_ns);
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, count);
}

/// rgb.txt and depth.txt with times that `write` makes of microseconds.
TumListing listed(const NameOf& write_color, const NameOf& write_depth, bool twice = false) {
  const test::TempFolder folder;
  std::string rgb, depth;
  for (int i = 0; i < 20; ++i) {
    for (int copy = 0; copy < (twice ? 2 : 1); ++copy) {
      rgb += fmt::format("{} rgb/{}.png\n", write_color(micros(i)), i);
      depth += fmt::format("{} depth/{}.png\n", write_depth(micros(i) + 2'000), i);
    }
  }
  folder.write("rgb.txt", rgb);
  folder.write("depth.txt", depth);
  return read_tum_listing(folder.path());
}

TEST(Lists, MayHaveTimesInAnyUnit) {
  const NameOf seconds = [](int64_t us) { return fmt::format("{}.{:06}", us / 1'000'000, us % 1'000'000); };
  const NameOf nanoseconds = [](int64_t us) { return fmt::format("{}", us * 1000); };
  const NameOf microseconds = [](int64_t us) { return fmt::format("{}", us); };
  const NameOf milliseconds = [](int64_t us) { return fmt::format("{}.{:03}", us / 1000, us % 1000); };
  for (const NameOf& color : {seconds, nanoseconds, microseconds, milliseconds}) {
    for (const NameOf& depth : {seconds, nanoseconds, microseconds, milliseconds}) {
      const TumListing listing = listed(color, depth);
      ASSERT_THAT(listing.frames, SizeIs(20));
      EXPECT_EQ(listing.frames[3].stamp_ns, micros(3) * 1000);
      EXPECT_EQ(listing.frames[3].depth_stamp_ns, micros(3) * 1000 + 2'000'000);
    }
  }
  EXPECT_THAT(listed(seconds, nanoseconds).pairing.times, HasSubstr("nanoseconds (depth.txt)"));
  EXPECT_EQ(listed(seconds, seconds).pairing.times, "");
  const NameOf uptime = [](int64_t us) { return fmt::format("{}", (us - kStart_s * 1'000'000) * 1000); };
  EXPECT_EQ(listed(uptime, uptime).frames[3].stamp_ns, 200'000'000);
}

TEST(Lists, LinesThatRepeatAreNoLoss) {
  const NameOf seconds = [](int64_t us) { return fmt::format("{}.{:06}", us / 1'000'000, us % 1'000'000); };
  const TumListing listing = listed(seconds, seconds, true);
  EXPECT_THAT(listing.frames, SizeIs(20));
  EXPECT_EQ(listing.skipped.size(), 0U);
  EXPECT_EQ(listing.pairing.color.count, 0U);
}

}  // namespace
}  // namespace kinloop
