#include "kinloop/base/give_way.hpp"

#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

namespace kinloop {
namespace {

int own_nice() {
  return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
}

TEST(GiveWay, LowersTheCallingThreadAlone) {
  const int before = own_nice();
  int of_worker = before;
  std::thread worker([&] {
    give_way();
    of_worker = own_nice();
  });
  worker.join();
  EXPECT_GT(of_worker, before);
  EXPECT_EQ(own_nice(), before);
}

}  // namespace
}  // namespace kinloop
