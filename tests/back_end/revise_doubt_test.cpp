#include "kinloop/back_end/final/revise_doubt.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tests/back_end/steady_log.hpp"

namespace kinloop {
namespace {

class Doubt : public test::SteadyLog {
 protected:
  Doubt() : SteadyLog(180) {
    for (LoggedFrame& entry : log_) entry.evidence.surfaces = {2000, 20, 0};
  }

  void contradict(size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) log_[i].evidence.surfaces = {1600, 400, 0};
  }

  /// The indices of the doubtful frames.
  [[nodiscard]] std::vector<size_t> doubtful(size_t first = 0) const {
    std::vector<size_t> found;
    const FrameLog revised = revise_doubt(log_, first, map_);
    for (size_t i = 0; i < revised.size(); ++i) {
      if (revised[i].is_doubtful()) found.push_back(i);
    }
    return found;
  }
};

TEST_F(Doubt, IsNotRaisedByASteadyMotion) {
  EXPECT_TRUE(doubtful().empty());
}

TEST_F(Doubt, IsNotRaisedByAHandThatReversesWithOneG) {
  for (size_t i = 90; i < 180; ++i) {
    const double s = static_cast<double>(i - 90) / 30;
    log_[i].T_reference_camera.translation.x() = 1.8 + 0.6 * s - 0.5 * 9.81 * s * s;
  }
  EXPECT_TRUE(doubtful().empty());
}

TEST_F(Doubt, IsRaisedByAPoseThatJumps) {
  log_[90].T_reference_camera.translation.y() = 0.2;
  const auto found = doubtful();
  EXPECT_EQ(found, (std::vector<size_t>{89, 90, 91, 92}));
}

TEST_F(Doubt, IsRaisedByATurnThatNoHandMakes) {
  log_[90].T_reference_camera.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY());
  EXPECT_EQ(doubtful(), (std::vector<size_t>{89, 90, 91, 92}));
}

TEST_F(Doubt, IsNotRaisedAfterImagesThatRepeat) {
  for (size_t i = 80; i < 90; ++i) {
    log_[i].method = TrackingMethod::kRepeat;
    log_[i].T_reference_camera = log_[79].T_reference_camera;
  }
  EXPECT_TRUE(doubtful().empty());
}

TEST_F(Doubt, IsNotRaisedByTwoComponents) {
  for (size_t i = 90; i < 180; ++i) log_[i].reference = KeyframeId{1};
  for (size_t i = 90; i < 180; ++i) log_[i].T_reference_camera.translation.x() += 5;
  EXPECT_TRUE(doubtful().empty());
}

TEST_F(Doubt, ReachesBackToWhereTheSurfacesBeganToContradict) {
  contradict(60, 100);
  for (size_t i = 95; i < 100; ++i) kinloop::doubt(log_[i], DoubtCause::kUnknown);
  const auto found = doubtful();
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(static_cast<double>(found.front()), 60, 5);
  EXPECT_EQ(found.back(), 99);
}

TEST_F(Doubt, ReachesTwoSeconds) {
  contradict(0, 180);
  for (const size_t i : {90, 91}) kinloop::doubt(log_[i], DoubtCause::kUnknown);
  const auto found = doubtful();
  EXPECT_EQ(found.front(), 30);
  EXPECT_EQ(found.back(), 151);
}

TEST_F(Doubt, ReachesOverWhatMoves) {
  for (size_t i = 70; i < 95; ++i) log_[i].evidence.moved_share = 0.3;
  for (size_t i = 90; i < 95; ++i) log_[i].outcome = TrackingOutcome::kLost;
  const auto found = doubtful();
  ASSERT_FALSE(found.empty());
  EXPECT_LT(found.front(), 75);
}

TEST_F(Doubt, OfOneFrameStaysThere) {
  contradict(60, 120);
  kinloop::doubt(log_[90], DoubtCause::kUnknown);
  EXPECT_EQ(doubtful(), std::vector<size_t>{90});
}

TEST_F(Doubt, DoesNotSpreadWhereTheViewAgrees) {
  for (size_t i = 90; i < 95; ++i) kinloop::doubt(log_[i], DoubtCause::kUnknown);
  EXPECT_EQ(doubtful().size(), 5);
}

TEST_F(Doubt, DoesNotReachFramesOfEarlierSessions) {
  contradict(0, 180);
  for (const size_t i : {90, 91}) kinloop::doubt(log_[i], DoubtCause::kUnknown);
  EXPECT_EQ(doubtful(90).front(), 90);
}

TEST_F(Doubt, OfNoFramesIsNone) {
  log_.clear();
  EXPECT_TRUE(doubtful().empty());
}

TEST_F(Doubt, FindsWhereTheSurfacesBeganToContradict) {
  contradict(60, 100);
  const auto begin = contradiction_start(log_, 0, 99);
  ASSERT_TRUE(begin);
  EXPECT_NEAR(static_cast<double>(*begin), 60, 5);
  EXPECT_EQ(contradiction_start(log_, 0, 30), std::nullopt);
  EXPECT_EQ(contradiction_start(log_, 80, 99), 80);
}

TEST_F(Doubt, LooksTwoSecondsBackForTheBeginOfAContradiction) {
  contradict(0, 180);
  EXPECT_EQ(contradiction_start(log_, 0, 150), 90);
}

TEST_F(Doubt, DoesNotTakeWhatIsKnownToHaveMovedForAContradiction) {
  for (size_t i = 60; i < 100; ++i) log_[i].evidence.moved_share = 0.5;
  EXPECT_EQ(contradiction_start(log_, 0, 99), std::nullopt);
}

}  // namespace
}  // namespace kinloop
