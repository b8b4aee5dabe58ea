#include "apps/view/shown_feed.hpp"

#include <chrono>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/viewer/scene_parts.hpp"

namespace kinloop {
namespace {

/// What is shown of a map: its name, and an image of a keyframe.
Shown shown_map(const std::string& name) {
  SavedRun run;
  run.name = name;
  return {.show = [run](Scene& scene) { show_saved_run(scene, run); },
          .rest = {[] {
                     return std::vector<EncodedPart>{{PartKind::kCloud, 9, {1}}};
                   },
                   [] {
                     return std::vector<EncodedPart>{{PartKind::kKeyframeImage, 4, {1, 2}}};
                   }},
          .tell = [run](Scene& scene, const Notice& notice) { show_notice(scene, run, notice); }};
}

class Feed : public testing::Test {
 protected:
  /// Updates the scene until it fulfils the condition.
  template <class Condition>
  void update_until(ShownFeed& feed, const Condition& condition) {
    for (int i = 0; i < 10'000 && !condition(); ++i) {
      feed.work();
      feed.update(scene_);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_TRUE(condition());
  }

  [[nodiscard]] bool shows(PartKind kind) const { return test::part(scene_, kind).has_value(); }
  [[nodiscard]] nlohmann::json json_of(PartKind kind) const {
    return test::json_of(test::part(scene_, kind).value());
  }
  [[nodiscard]] std::string message() const { return json_of(PartKind::kStatus).value("message", ""); }

  Scene scene_{"first"};
};

TEST_F(Feed, AWithdrawnLoopGivesAnotherScene) {
  Shown before = shown_map("before");
  std::string withdrawn;
  before.withdraw = [&](const std::string& loop) {
    withdrawn = loop;
    Shown after = shown_map("after");
    after.greeting = "done";
    return after;
  };
  ShownFeed feed(before);
  update_until(feed, [&] { return shows(PartKind::kKeyframeImage); });
  EXPECT_EQ(json_of(PartKind::kHello)["run"], "first");
  feed.take({CommandKind::kWithdrawLoop, "1.5,2.5"});
  feed.update(scene_);
  EXPECT_EQ(json_of(PartKind::kStatus)["busy"], true);
  update_until(feed, [&] { return message() == "done"; });
  EXPECT_EQ(withdrawn, "1.5,2.5");
  EXPECT_EQ(json_of(PartKind::kHello)["input"], "after");
  EXPECT_NE(json_of(PartKind::kHello)["run"], "first") << "browsers forget what they have";
  EXPECT_EQ(json_of(PartKind::kStatus)["busy"], false);
  update_until(feed, [&] { return shows(PartKind::kKeyframeImage); });
}

TEST_F(Feed, ShowsWhatAPictureNeedsBeforeTheRestWhichIsInOrder) {
  Shown shown = shown_map("map");
  shown.show = [](Scene& scene) { scene.put(PartKind::kHello, 0, {1}); };
  ShownFeed feed(shown);
  feed.update(scene_);
  EXPECT_TRUE(shows(PartKind::kHello));
  EXPECT_FALSE(shows(PartKind::kCloud));
  update_until(feed, [&] { return shows(PartKind::kCloud); });
  EXPECT_FALSE(shows(PartKind::kKeyframeImage)) << "one after the other";
  update_until(feed, [&] { return shows(PartKind::kKeyframeImage); });
}

TEST_F(Feed, WhatCannotBePreparedIsLeftOut) {
  Shown shown = shown_map("map");
  shown.rest[0] = []() -> std::vector<EncodedPart> { throw std::runtime_error("damaged"); };
  ShownFeed feed(shown);
  update_until(feed, [&] { return shows(PartKind::kKeyframeImage); });
  EXPECT_FALSE(shows(PartKind::kCloud));
}

TEST_F(Feed, NoLoopIsWithdrawnBeforeAllOfTheMapIsPrepared) {
  Shown shown = shown_map("map");
  shown.withdraw = [&](const std::string&) { return shown_map("after"); };
  ShownFeed feed(shown);
  feed.update(scene_);
  feed.take({CommandKind::kWithdrawLoop, "1,2"});
  update_until(feed, [&] { return shows(PartKind::kKeyframeImage); });
  EXPECT_EQ(message(), "The map is still being prepared; try again in a moment.");
  feed.take({CommandKind::kWithdrawLoop, "1,2"});
  update_until(feed, [&] { return json_of(PartKind::kHello)["input"] == "after"; });
}

TEST_F(Feed, SaysWhyALoopWasNotWithdrawn) {
  Shown shown = shown_map("map");
  shown.withdraw = [](const std::string&) -> Shown { throw std::runtime_error("no such loop"); };
  ShownFeed feed(shown);
  update_until(feed, [&] { return shows(PartKind::kKeyframeImage); });
  feed.take({CommandKind::kWithdrawLoop, "1,2"});
  update_until(feed, [&] { return message() == "no such loop"; });
  EXPECT_EQ(json_of(PartKind::kStatus)["busy"], false);
  EXPECT_EQ(json_of(PartKind::kHello)["run"], "first");
}

TEST_F(Feed, OneLoopIsWithdrawnAtATime) {
  Shown shown = shown_map("map");
  std::vector<std::string> withdrawn;
  shown.withdraw = [&](const std::string& loop) {
    withdrawn.push_back(loop);
    return shown_map("after");
  };
  ShownFeed feed(shown);
  update_until(feed, [&] { return shows(PartKind::kKeyframeImage); });
  feed.take({CommandKind::kWithdrawLoop, "1,2"});
  feed.take({CommandKind::kWithdrawLoop, "3,4"});
  update_until(feed, [&] { return json_of(PartKind::kHello)["input"] == "after"; });
  EXPECT_THAT(withdrawn, testing::ElementsAre("1,2"));
}

TEST_F(Feed, WhereThereIsNoMapCommandsAreIgnored) {
  ShownFeed feed(shown_map("cloud"));
  feed.take({CommandKind::kWithdrawLoop, "1,2"});
  feed.take({CommandKind::kPause});
  update_until(feed, [&] { return shows(PartKind::kKeyframeImage); });
  EXPECT_EQ(message(), "");
}

}  // namespace
}  // namespace kinloop
