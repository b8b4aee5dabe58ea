#include "kinloop/base/give_way.hpp"

#include <sys/resource.h>
#include <unistd.h>

namespace kinloop {

void give_way() {
  // On Linux the "process" of a thread's number is that thread alone. Where the system refuses, nothing but
  // speed is lost.
  constexpr int kNice = 15;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
}

}  // namespace kinloop
