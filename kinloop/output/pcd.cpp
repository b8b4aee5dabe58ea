#include "kinloop/output/pcd.hpp"

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/text_file.hpp"
#include "kinloop/output/byte_stream.hpp"

namespace kinloop {

void write_pcd(const std::filesystem::path& path, const ColoredCloud& cloud) {
  require(cloud.points.size() == cloud.colors.size(), "write_pcd: one colour per point");
  AtomicFile file(path);
  file.stream() << fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\n"
      "TYPE F F F U\nCOUNT 1 1 1 1\nWIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary\n",
      cloud.size());
  std::string bytes;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const auto& [red, green, blue] = cloud.colors[i];
    const uint8_t bgra[] = {blue, green, red, 0};
    put_values(bytes, cloud.points[i].data(), 3);
    put_values(bytes, bgra, 4);
  }
  file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.commit();
}

}  // namespace kinloop
