#include "session/program_name.hpp"

namespace kinloop {

std::string program_name() {
  return "kinloop " KINLOOP_VERSION;
}

}  // namespace kinloop
