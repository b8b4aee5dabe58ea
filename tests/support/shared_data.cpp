#include "tests/support/shared_data.hpp"

namespace kinloop::test {

std::filesystem::path source_folder() {
  return KINLOOP_SOURCE_DIR;
}

std::filesystem::path shared_data(const std::filesystem::path& name) {
  return source_folder().parent_path() / "shared" / "data" / name;
}

}  // namespace kinloop::test
