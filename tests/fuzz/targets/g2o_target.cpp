#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"
#include "tools/export/g2o/g2o_file.hpp"

namespace kinloop::fuzz {

void read_g2o_bytes(std::string_view bytes) {
  with_file("graph.g2o", bytes, [](const auto& path) {
    accept([&] {
      const G2oFile file = read_g2o(path);
      write_g2o(path, file);
      const G2oFile again = read_g2o(path);
      require(again.graph.index() == file.graph.index() && again.repaired_lines.empty(),
              "a graph that was read is not the same when it is written");
    });
  });
}

}  // namespace kinloop::fuzz
