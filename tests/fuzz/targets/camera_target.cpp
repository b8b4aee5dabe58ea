#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace kinloop::fuzz {
namespace {

/// The name tells whether damaged JSON or YAML is an error, or text in another format.
void read_foreign_camera(const std::string& name, std::string_view bytes) {
  with_file(name, bytes, [](const auto& path) {
    accept([&] {
      auto description = find_description(path);
      if (!description) return;
      PinholeCamera& lens = description->camera.color;
      if (!description->has_size()) lens.width = lens.height = 1;
      expect_possible(description->camera);
    });
  });
}

}  // namespace

void read_camera_bytes(std::string_view bytes) {
  with_file("camera.yaml", bytes, [](const auto& path) {
    accept([&] {
      const RgbdCamera camera = read_camera_file(path);
      expect_possible(camera);
      write_camera_file(path, camera);
      require(read_camera_file(path).color == camera.color,
              "a camera that was read is not the same when written");
    });
  });
  for (const char* name : {"camera.txt", "camera.json", "camera.yml"}) read_foreign_camera(name, bytes);
}

}  // namespace kinloop::fuzz
