#include "kinloop/core/options.hpp"

#include <functional>
#include <optional>
#include <sstream>

#include <gmock/gmock.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>

#include "kinloop/core/log.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::usage_error;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

enum class Solver { kAuto, kG2o, kCeres };

constexpr auto option_names(Solver) {
  return std::to_array<EnumName<Solver>>(
      {{Solver::kAuto, "auto"}, {Solver::kG2o, "g2o"}, {Solver::kCeres, "ceres"}});
}

struct InnerOptions {
  int count = 1000;
  double ratio = 0.5;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("count", self.count, "keypoints kept", Range{50, 20000});
    visit("ratio", self.ratio, "share of them", Range{0, 1});
  }
};

struct OuterOptions {
  InnerOptions inner;
  bool loops = true;
  Solver solver = Solver::kAuto;
  std::string title = "room";
  double offset = -1.5;
  int at_least = 3;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("inner", self.inner);
    visit("loops", self.loops, "close loops");
    visit("solver", self.solver, "who solves");
    visit("title", self.title, "shown above the report");
    visit("offset", self.offset, "metres");
    visit("at_least", self.at_least, "things", Range{1});
  }
};

OuterOptions with(std::vector<std::string> assignments) {
  return with_assignments(OuterOptions{}, assignments);
}

std::string error(const std::string& assignment) {
  return usage_error([&] { with({assignment}); });
}

TEST(Options, EveryFieldIsListedOnceInOrderWithItsValue) {
  OuterOptions options;
  std::vector<std::string> lines;
  for (const auto& entry : option_entries(options)) lines.push_back(entry.key + "=" + to_text(entry.value));
  EXPECT_THAT(lines, ElementsAre("inner.count=1000", "inner.ratio=0.5", "loops=true", "solver=auto",
                                 "title=room", "offset=-1.5", "at_least=3"));
}

TEST(Options, EveryTypeCanBeSet) {
  const auto options = with({"inner.count=50", "inner.ratio=1e-1", "loops=off", "solver=g2o", "title=a=b c",
                             "offset=-2", "at_least=1"});
  EXPECT_EQ(options.inner.count, 50);
  EXPECT_EQ(options.inner.ratio, 0.1);
  EXPECT_FALSE(options.loops);
  EXPECT_EQ(options.solver, Solver::kG2o);
  EXPECT_EQ(options.title, "a=b c");
  EXPECT_EQ(options.offset, -2);
  EXPECT_EQ(options.at_least, 1);
}

TEST(Options, TheLastAssignmentWins) {
  EXPECT_EQ(with({"at_least=5", "at_least=7"}).at_least, 7);
}

TEST(Options, WhatIsListedCanBeSetAgain) {
  auto changed = with({"inner.ratio=0.30000000000000004", "loops=false", "offset=1e-300"});
  std::vector<std::string> assignments;
  for (const auto& entry : option_entries(changed))
    assignments.push_back(entry.key + "=" + to_text(entry.value));
  const auto again = with_assignments(OuterOptions{}, assignments);
  EXPECT_EQ(again.inner.ratio, changed.inner.ratio);
  EXPECT_EQ(again.loops, changed.loops);
  EXPECT_EQ(again.offset, changed.offset);
}

TEST(Options, UnknownKeyNamesTheNearest) {
  EXPECT_THAT(error("inner.cuont=5"), AllOf(HasSubstr("'inner.cuont'"), HasSubstr("'inner.count'")));
  EXPECT_THAT(error("solvr=g2o"), HasSubstr("'solver'"));
  EXPECT_THAT(error("=5"), HasSubstr("unknown option ''"));
  EXPECT_THAT(usage_error([] { apply_assignment({}, "a=1"); }), HasSubstr("'a'"));
}

TEST(Options, AnAssignmentNeedsAnEqualsSign) {
  EXPECT_THAT(error("loops"), HasSubstr("expected key=value"));
}

TEST(Options, RangesIncludeTheirEnds) {
  EXPECT_EQ(with({"inner.count=20000"}).inner.count, 20000);
  EXPECT_EQ(with({"inner.ratio=0"}).inner.ratio, 0);
  EXPECT_THAT(error("inner.count=49"), AllOf(HasSubstr("inner.count"), HasSubstr("from 50 to 20000")));
  EXPECT_THAT(error("inner.count=20001"), HasSubstr("'20001'"));
  EXPECT_THAT(error("inner.ratio=1.0001"), HasSubstr("from 0 to 1"));
  EXPECT_THAT(error("at_least=0"), HasSubstr("at least 1"));
}

TEST(Options, BadValuesNameKeyAndExpectation) {
  for (const char* value : {"", "ten", "10.5", "1e3", "99999999999", "10 ", "0x80"}) {
    EXPECT_THAT(error(std::string("inner.count=") + value),
                AllOf(HasSubstr("inner.count"), HasSubstr("a whole number")));
  }
  for (const char* value : {"", "half", "nan", "inf", "0,5", "1e999"}) {
    EXPECT_THAT(error(std::string("offset=") + value), AllOf(HasSubstr("offset"), HasSubstr("a number")));
  }
  EXPECT_THAT(error("loops=maybe"), HasSubstr("true or false"));
  EXPECT_THAT(error("solver=magic"), HasSubstr("one of auto, g2o, ceres"));
}

TEST(Options, HelpHasKeyDefaultMeaningAndExpectation) {
  OuterOptions options;
  EXPECT_THAT(options_help(option_entries(options)),
              AllOf(HasSubstr("inner.count=1000"), HasSubstr("keypoints kept"), HasSubstr("from 50 to 20000"),
                    HasSubstr("one of auto, g2o, ceres")));
}

struct TunedOptions {
  InnerOptions tuning;
  InnerOptions usual;
  int border_px = 16;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("tuning", self.tuning, Expert{});
    visit("usual", self.usual);
    visit("border_px", self.border_px, "margin without keypoints, px", Range{0, 100}, Expert{});
  }

  static OptionHistory history() {
    return {{{"edge_px", "border_px"}, {"fine.number", "fine.count"}, {"fine.*", "tuning.*"}},
            {"gone", "tuning.gone", "lost.*"}};
  }
};

TEST(ExpertOptions, AreListedOnlyWithAll) {
  TunedOptions options;
  const auto entries = option_entries(options);
  EXPECT_THAT(options_help(entries),
              AllOf(HasSubstr("usual.count=1000"), Not(HasSubstr("tuning.")), Not(HasSubstr("border_px"))));
  EXPECT_THAT(options_help(entries, OptionSelection::kAll),
              AllOf(HasSubstr("usual.count=1000"), HasSubstr("tuning.ratio=0.5"), HasSubstr("border_px=16")));
}

TEST(ExpertOptions, CanBeSetAndAreCheckedLikeOthers) {
  const auto options = with_assignments(TunedOptions{}, std::vector<std::string>{"tuning.count=60"});
  EXPECT_EQ(options.tuning.count, 60);
  EXPECT_THAT(
      usage_error([] { with_assignments(TunedOptions{}, std::vector<std::string>{"border_px=101"}); }),
      HasSubstr("from 0 to 100"));
}

/// What the program says while `call` runs.
std::string log_of(const std::function<void()>& call) {
  std::ostringstream text;
  const auto usual = spdlog::default_logger();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text)));
  call();
  spdlog::set_default_logger(usual);
  return text.str();
}

TunedOptions tuned_with(const std::string& assignment) {
  return with_assignments(TunedOptions{}, std::vector{assignment});
}

TEST(FormerOptions, WorkWithAWarning) {
  const auto said = log_of([] { EXPECT_EQ(tuned_with("edge_px=3").border_px, 3); });
  EXPECT_THAT(said, HasSubstr("option edge_px is now called border_px"));
  const auto said_of_group = log_of([] { EXPECT_EQ(tuned_with("fine.ratio=0.25").tuning.ratio, 0.25); });
  EXPECT_THAT(said_of_group, HasSubstr("option fine.ratio is now called tuning.ratio"));
  // A key renamed in a group that was renamed, too.
  const auto said_of_both = log_of([] { EXPECT_EQ(tuned_with("fine.number=70").tuning.count, 70); });
  EXPECT_THAT(said_of_both, HasSubstr("option fine.number is now called tuning.count"));
  EXPECT_THAT(log_of([] { tuned_with("border_px=3"); }), testing::IsEmpty());
}

TEST(FormerOptions, ThatNoLongerExistAreIgnoredWithAWarning) {
  for (const std::string key : {"gone", "fine.gone", "lost.anything"})
    EXPECT_THAT(log_of([&] { tuned_with(key + "=1"); }),
                HasSubstr("option " + key + " no longer exists and is ignored"));
}

TEST(FormerOptions, AreCheckedByTheRulesOfToday) {
  EXPECT_THAT(usage_error([] { tuned_with("edge_px=-1"); }),
              AllOf(HasSubstr("border_px"), HasSubstr("'-1'")));
  EXPECT_THAT(usage_error([] { tuned_with("fine.unheard_of=1"); }), HasSubstr("'fine.unheard_of'"));
  EXPECT_THAT(usage_error([] { tuned_with("lost=1"); }), HasSubstr("unknown option 'lost'"));
}

TEST(ValidateOptions, AcceptsDefaultsAndTheEndsOfRanges) {
  OuterOptions options;
  EXPECT_NO_THROW(validate(options));
  options.inner.ratio = 1;
  options.inner.count = 50;
  EXPECT_NO_THROW(validate(options));
}

TEST(NamedEnum, HasOneValueForEachName) {
  EXPECT_EQ(value_named<Solver>("g2o"), Solver::kG2o);
  EXPECT_EQ(value_named<Solver>("G2O"), std::nullopt);
}

TEST(ValidateOptions, NamesKeyValueAndExpectation) {
  OuterOptions options;
  options.inner.count = 49;
  EXPECT_THAT(usage_error([&] { validate(options); }),
              AllOf(HasSubstr("inner.count"), HasSubstr("'49'"), HasSubstr("from 50 to 20000")));
  EXPECT_THAT(usage_error([&] { validate(options, "outer."); }), HasSubstr("outer.inner.count"));
}

TEST(ValidateOptions, RejectsNumbersThatAreNotFinite) {
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    OuterOptions options;
    options.offset = value;
    EXPECT_THAT(usage_error([&] { validate(options); }), AllOf(HasSubstr("offset"), HasSubstr("a number")));
  }
}

TEST(ValidateOptions, RejectsValuesOutsideOfAnEnum) {
  OuterOptions options;
  options.solver = static_cast<Solver>(17);
  EXPECT_THAT(usage_error([&] { validate(options); }),
              AllOf(HasSubstr("solver"), HasSubstr("one of auto, g2o, ceres")));
}

}  // namespace
}  // namespace kinloop
