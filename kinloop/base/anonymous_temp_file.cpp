#include "kinloop/base/anonymous_temp_file.hpp"

#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <unistd.h>

namespace kinloop {

int open_anonymous_temp_file(const std::filesystem::path& folder) {
  std::string name = (folder / "kinloop_XXXXXX").string();
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor >= 0) unlink(name.c_str());
  return descriptor;
}

}  // namespace kinloop
