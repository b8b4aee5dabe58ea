// How Ctrl-C ends work whose unfinished result is of no use.

#include "apps/shared/terminal/interrupt.hpp"

#include <csignal>
#include <vector>

#include <gtest/gtest.h>

namespace kinloop {
namespace {

TEST(Interrupt, EndsWorkThatReportsItsProgress) {
  std::vector<size_t> shown;
  const Progress progress = interruptible([&](const ProgressReport& now) {
    shown.push_back(now.done);
    return true;
  });
  const Progress silent = interruptible({});
  install_interrupt_handler();
  EXPECT_TRUE(report(progress, "work", 1, 2));
  EXPECT_TRUE(report(silent, "work", 1, 2));
  EXPECT_NO_THROW(throw_if_interrupted());
  std::raise(SIGINT);
  EXPECT_THROW(report(silent, "work", 2, 2), Interrupted);
  try {
    report(progress, "work", 2, 2);
    FAIL() << "the work goes on";
  } catch (const Interrupted& interrupted) {
    EXPECT_EQ(interrupted.signal(), SIGINT);
  }
  EXPECT_EQ(shown, std::vector<size_t>{1});
}

}  // namespace
}  // namespace kinloop
