#include "drivers/azure/azure_recording.hpp"
#include "drivers/azure/azure_source.hpp"
#include "drivers/datasets/open_sequence.hpp"
#include "drivers/openni2/oni_source.hpp"
#include "drivers/ros/bag_source.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace kinloop::fuzz {
namespace {

/// The kinds of recordings, each with its own camera.
template <auto kOpen>
void read_recorded_bytes(const char* name, std::string_view bytes) {
  with_file(name, bytes, [](const auto& path) { accept([&] { read_frames(*kOpen(path)); }); });
}

constexpr auto kOpenBag = [](const std::filesystem::path& path) { return open_bag(path, {}); };
constexpr auto kOpenSequence = [](const std::filesystem::path& path) { return open_sequence(path.string()); };

}  // namespace

void read_ros1_bag_bytes(std::string_view bytes) {
  read_recorded_bytes<kOpenBag>("a.bag", bytes);
}

void read_mcap_bytes(std::string_view bytes) {
  read_recorded_bytes<kOpenBag>("a.mcap", bytes);
}

void read_sqlite_bag_bytes(std::string_view bytes) {
  read_recorded_bytes<kOpenBag>("a.db3", bytes);
}

void read_azure_bytes(std::string_view bytes) {
  // That of the factory is for images of at least 320 x 288 pixels, of which a frame takes a second here.
  constexpr auto kOpen = [](const std::filesystem::path& path) {
    RgbdCamera camera;
    camera.color = {16, 9, 14, 14, 8, 4, {}};
    camera.depth = {12, 10, 8, 8, 6, 5, {}};
    return open_azure_recording(path, camera);
  };
  read_recorded_bytes<kOpen>("a.mkv", bytes);
}

void read_oni_bytes(std::string_view bytes) {
  constexpr auto kOpen = [](const std::filesystem::path& path) { return open_oni_recording(path, {}); };
  read_recorded_bytes<kOpen>("a.oni", bytes);
}

void read_sens_bytes(std::string_view bytes) {
  read_recorded_bytes<kOpenSequence>("a.sens", bytes);
}

void read_layout_bytes(std::string_view bytes) {
  with_folder(bytes,
              [](const auto& folder) { accept([&] { read_frames(*open_sequence(folder.string())); }); });
}

void read_azure_calibration_bytes(std::string_view bytes) {
  accept([&] {
    const auto calibration = read_azure_calibration(std::string(bytes), {1280, 720}, {640, 576});
    RgbdCamera camera;
    camera.color = calibration.color, camera.depth = calibration.depth;
    camera.T_color_depth = calibration.T_color_depth;
    expect_possible(camera);
  });
}

}  // namespace kinloop::fuzz
