#include "kinloop/base/give_way.hpp"

#include <sys/resource.h>
#include <unistd.h>

namespace kinloop {

void give_way(GiveWay share) {
  // On Linux the "process" of a thread's number is that thread alone. Where the system refuses, nothing but
  // speed is lost.
  const int nice = share == GiveWay::kMost ? 10 : 15;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), nice);
}

}  // namespace kinloop
