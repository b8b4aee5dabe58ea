#include "kinloop/sensor/camera/camera_file.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace kinloop::fuzz {

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
}

}  // namespace kinloop::fuzz
