#pragma once
// A fake Kinect 2, and libfreenect2's replay of its depth packets.

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <libfreenect2/libfreenect2.hpp>
#include <libfreenect2/packet_pipeline.h>

namespace kinloop::test {

/// The parameters of an undistorted pinhole camera.
inline libfreenect2::Freenect2Device::IrCameraParams infrared_params() {
  libfreenect2::Freenect2Device::IrCameraParams p{};
  p.fx = p.fy = 365;
  p.cx = 257, p.cy = 207;
  return p;
}

/// libfreenect2's polynomial for two parallel pinhole cameras `baseline_mm` apart.
inline libfreenect2::Freenect2Device::ColorCameraParams color_params(float baseline_mm) {
  constexpr float kDepthQ = 0.01F, kColorQ = 0.002199F;  // its fixed-point factors
  libfreenect2::Freenect2Device::ColorCameraParams p{};
  p.fx = p.fy = 1081;
  p.cx = 959.5F, p.cy = 539.5F;
  p.shift_d = 863, p.shift_m = baseline_mm;
  p.mx_x1y0 = p.fx * kColorQ / (infrared_params().fx * kDepthQ);
  p.mx_x0y0 = p.fx * kColorQ * p.shift_m / p.shift_d;
  p.my_x0y1 = p.fy * kColorQ / (infrared_params().fy * kDepthQ);
  return p;
}

/// Passes the frames of `play` to its listener when started, and then nothing more, as if unplugged.
class FakeKinect2 : public libfreenect2::Freenect2Device {
 public:
  using Play = std::function<void(libfreenect2::FrameListener&)>;
  explicit FakeKinect2(Play play) : play_(std::move(play)) {}

  std::string getSerialNumber() override { return "fake"; }
  std::string getFirmwareVersion() override { return "fake"; }
  ColorCameraParams getColorCameraParams() override { return color_params(52); }
  IrCameraParams getIrCameraParams() override { return infrared_params(); }
  void setColorCameraParams(const ColorCameraParams&) override {}
  void setIrCameraParams(const IrCameraParams&) override {}
  void setConfiguration(const Config&) override {}
  void setColorFrameListener(libfreenect2::FrameListener*) override {}
  void setIrAndDepthFrameListener(libfreenect2::FrameListener* listener) override { listener_ = listener; }
  void setColorAutoExposure(float) override {}
  void setColorSemiAutoExposure(float) override {}
  void setColorManualExposure(float, float) override {}
  void setColorSetting(libfreenect2::ColorSettingCommandType, uint32_t) override {}
  void setColorSetting(libfreenect2::ColorSettingCommandType, float) override {}
  uint32_t getColorSetting(libfreenect2::ColorSettingCommandType) override { return 0; }
  float getColorSettingFloat(libfreenect2::ColorSettingCommandType) override { return 0; }
  void setLedStatus(libfreenect2::LedSettings) override {}
  bool start() override {
    play_(*listener_);
    return true;
  }
  bool startStreams(bool, bool) override { return start(); }
  bool stop() override { return true; }
  bool close() override { return true; }

 private:
  Play play_;
  libfreenect2::FrameListener* listener_ = nullptr;
};

/// Passes frames on and signals the arrival of the depth image.
class Arrival : public libfreenect2::FrameListener {
 public:
  explicit Arrival(libfreenect2::FrameListener& to) : to_(to) {}
  bool onNewFrame(libfreenect2::Frame::Type type, libfreenect2::Frame* frame) override {
    to_.onNewFrame(type, frame);
    const std::lock_guard lock(mutex_);
    arrived_ = arrived_ || type == libfreenect2::Frame::Depth;
    changed_.notify_all();
    return false;
  }
  bool wait(std::chrono::seconds timeout) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, timeout, [this] { return arrived_; });
  }

 private:
  libfreenect2::FrameListener& to_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool arrived_ = false;
};

/// Decodes the packet in the file with libfreenect2's replay, and returns when `listener` has received its
/// depth image; false if none came. libfreenect2 0.2's replay cannot be stopped after a packet: its thread
/// waits for ever in PoolAllocatorImpl::allocate for one of two buffers, one of which is held by the stream
/// parser and the other by the packet, which is never released; stop() and the destructor join the thread. So
/// each packet gets its own replay, which is left waiting.
inline bool replay_packet(const std::string& file, libfreenect2::FrameListener& listener) {
  struct Replay {
    explicit Replay(libfreenect2::FrameListener& to) : arrival(to) {}
    libfreenect2::Freenect2Replay context;
    Arrival arrival;
  };
  static auto* const left_waiting = new std::vector<Replay*>;
  left_waiting->push_back(new Replay(listener));
  Replay& replay = *left_waiting->back();
  auto* device =
      replay.context.openDevice(std::vector<std::string>{file}, new libfreenect2::CpuPacketPipeline);
  device->setIrCameraParams(infrared_params());
  device->setIrAndDepthFrameListener(&replay.arrival);
  device->start();
  return replay.arrival.wait(std::chrono::seconds(60));
}

}  // namespace kinloop::test
