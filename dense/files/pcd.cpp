#include "dense/files/pcd.hpp"

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_stream.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {

void write_pcd(const std::filesystem::path& path, const ColoredCloud& cloud, const FileFrame& frame) {
  require(cloud.points.size() == cloud.colors.size(), "write_pcd: expected one colour per point");
  const bool normals = !cloud.normals.empty();
  require(!normals || cloud.normals.size() == cloud.size(), "write_pcd: expected one normal per point");
  std::string bytes = "# .PCD v0.7 - Point Cloud Data file format\n";
  for (const std::string& comment : format_frame_comments(frame)) bytes += "# " + comment + "\n";
  fmt::format_to(std::back_inserter(bytes),
                 "VERSION 0.7\nFIELDS x y z rgb{1}\nSIZE 4 4 4 4{2}\nTYPE F F F U{3}\nCOUNT 1 1 1 1{4}\n"
                 "WIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary\n",
                 cloud.size(), normals ? " normal_x normal_y normal_z" : "", normals ? " 4 4 4" : "",
                 normals ? " F F F" : "", normals ? " 1 1 1" : "");
  for (size_t i = 0; i < cloud.size(); ++i) {
    const auto& [red, green, blue] = cloud.colors[i];
    const uint8_t bgra[] = {blue, green, red, 0};
    put_values(bytes, frame.to_file(cloud.points[i]).data(), 3);
    put_values(bytes, bgra, 4);
    if (normals) put_values(bytes, frame.to_file(cloud.normals[i]).data(), 3);
  }
  write_file(path, bytes);
}

}  // namespace kinloop
