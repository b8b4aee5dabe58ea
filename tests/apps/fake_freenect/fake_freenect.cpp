// A fake Kinect 1 that replaces libfreenect when preloaded (LD_PRELOAD): registered depth of 1 m + 10 mm per
// frame, colour of increasing brightness, and the device's 60 MHz clock. (Debian's fakenect only supports raw
// disparity.)

#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

#include <libfreenect.h>

namespace {

// A C API has one global device.
int device_token = 0;                  // NOLINT
void* user = nullptr;                  // NOLINT
freenect_video_cb on_video = nullptr;  // NOLINT
freenect_depth_cb on_depth = nullptr;  // NOLINT
uint32_t frame = 0;                    // NOLINT

auto* device() {
  return reinterpret_cast<freenect_device*>(&device_token);
}

}  // namespace

extern "C" {

int freenect_init(freenect_context** context, freenect_usb_context*) {
  *context = reinterpret_cast<freenect_context*>(&device_token);
  return 0;
}
int freenect_shutdown(freenect_context*) {
  return 0;
}
void freenect_set_log_level(freenect_context*, freenect_loglevel) {}
void freenect_select_subdevices(freenect_context*, freenect_device_flags) {}
int freenect_num_devices(freenect_context*) {
  return 1;
}
int freenect_list_device_attributes(freenect_context*, freenect_device_attributes** list) {
  static char serial[] = "A00367A00000042A";
  *list = new freenect_device_attributes{nullptr, serial};
  return 1;
}
void freenect_free_device_attributes(freenect_device_attributes* list) {
  delete list;
}
int freenect_open_device(freenect_context*, freenect_device** opened, int) {
  *opened = device();
  return 0;
}
int freenect_close_device(freenect_device*) {
  return 0;
}
void freenect_set_user(freenect_device*, void* value) {
  user = value;
}
void* freenect_get_user(freenect_device*) {
  return user;
}
void freenect_set_video_callback(freenect_device*, freenect_video_cb callback) {
  on_video = callback;
}
void freenect_set_depth_callback(freenect_device*, freenect_depth_cb callback) {
  on_depth = callback;
}
freenect_frame_mode freenect_find_video_mode(freenect_resolution, freenect_video_format) {
  return {};
}
freenect_frame_mode freenect_find_depth_mode(freenect_resolution, freenect_depth_format) {
  return {};
}
int freenect_set_video_mode(freenect_device*, freenect_frame_mode) {
  return 0;
}
int freenect_set_depth_mode(freenect_device*, const freenect_frame_mode) {
  return 0;
}
int freenect_start_video(freenect_device*) {
  return 0;
}
int freenect_start_depth(freenect_device*) {
  return 0;
}
int freenect_stop_video(freenect_device*) {
  return 0;
}
int freenect_stop_depth(freenect_device*) {
  return 0;
}

/// One frame per call, slowly enough that a busy machine loses none; the clock wraps around. Nothing after
/// the fifth, as if unplugged.
int freenect_process_events_timeout(freenect_context*, timeval*) {
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  constexpr uint32_t kFrames = 5, kTicksPerFrame = 2'000'000, kPixels = 640 * 480;
  if (frame == kFrames) return -1;
  const uint32_t ticks = 0xffffffffU - kTicksPerFrame + frame * kTicksPerFrame;
  std::vector<uint8_t> color(3 * kPixels, static_cast<uint8_t>(10 + frame));
  for (uint32_t i = 0; i < kPixels; ++i) color[3 * i] = 200;  // red
  std::vector<uint16_t> depth(kPixels, static_cast<uint16_t>(1000 + 10 * frame));
  on_video(device(), color.data(), ticks);
  on_depth(device(), depth.data(), ticks);
  ++frame;
  return 0;
}

}  // extern "C"
