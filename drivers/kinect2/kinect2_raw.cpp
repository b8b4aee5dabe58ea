#include "drivers/kinect2/kinect2_raw.hpp"

#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_FREENECT2

#include <chrono>
#include <string_view>
#include <thread>

#include <fmt/format.h>
#include <libfreenect2/packet_pipeline.h>

#include "drivers/kinect2/kinect2_factory.hpp"
#include "drivers/kinect2/kinect2_packets.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"

namespace kinloop {
namespace {

using DeviceFrame = libfreenect2::Frame;
using Device = libfreenect2::Freenect2Device;
using Clock = std::chrono::steady_clock;

template <class T>
void write_table(const std::filesystem::path& path, const T* values, size_t count) {
  if (values == nullptr) return;  // not sent by the device
  write_file(path, std::string_view(reinterpret_cast<const char*>(values), count * sizeof(T)));
}

/// Writes the tables from the device that depth decoding requires.
void write_tables(const std::filesystem::path& folder, libfreenect2::DumpPacketPipeline& pipeline) {
  size_t count = 0;
  const auto* p0 = pipeline.getDepthP0Tables(&count);
  write_table(folder / "p0_tables.bin", p0, count);
  const float* x = pipeline.getDepthXTable(&count);
  write_table(folder / "x_table.bin", x, count);
  const float* z = pipeline.getDepthZTable(&count);
  write_table(folder / "z_table.bin", z, count);
  const int16_t* lookup = pipeline.getDepthLookupTable(&count);
  write_table(folder / "lookup_table.bin", lookup, count);
}

std::string parameters_text(const Device::IrCameraParams& i, const Device::ColorCameraParams& c) {
  std::string text = fmt::format(
      "# As read from the device, for its mirrored images; names as in libfreenect2.\n"
      "infrared: {{fx: {}, fy: {}, cx: {}, cy: {}, k1: {}, k2: {}, k3: {}, p1: {}, p2: {}}}\n",
      i.fx, i.fy, i.cx, i.cy, i.k1, i.k2, i.k3, i.p1, i.p2);
  text += fmt::format("color: {{fx: {}, fy: {}, cx: {}, cy: {}, shift_d: {}, shift_m: {}}}\n", c.fx, c.fy,
                      c.cx, c.cy, c.shift_d, c.shift_m);
  text += fmt::format(
      "mx: {{x3y0: {}, x0y3: {}, x2y1: {}, x1y2: {}, x2y0: {}, x0y2: {}, x1y1: {}, x1y0: {}, x0y1: {}, x0y0: "
      "{}}}\n",
      c.mx_x3y0, c.mx_x0y3, c.mx_x2y1, c.mx_x1y2, c.mx_x2y0, c.mx_x0y2, c.mx_x1y1, c.mx_x1y0, c.mx_x0y1,
      c.mx_x0y0);
  return text + fmt::format(
                    "my: {{x3y0: {}, x0y3: {}, x2y1: {}, x1y2: {}, x2y0: {}, x0y2: {}, x1y1: {}, x1y0: {}, "
                    "x0y1: {}, x0y0: {}}}\n",
                    c.my_x3y0, c.my_x0y3, c.my_x2y1, c.my_x1y2, c.my_x2y0, c.my_x0y2, c.my_x1y1, c.my_x1y0,
                    c.my_x0y1, c.my_x0y0);
}

size_t packets(const RawPacketCounts& recording) {
  return recording.depth + recording.color;
}

/// Closes the device however the recording ends.
struct ClosedAtEnd {
  Kinect2Handle& handle;

  explicit ClosedAtEnd(Kinect2Handle& open) : handle(open) {}
  ~ClosedAtEnd() { close_kinect2(handle); }
  ClosedAtEnd(const ClosedAtEnd&) = delete;
  ClosedAtEnd& operator=(const ClosedAtEnd&) = delete;
};

}  // namespace

Kinect2PacketWriter::Kinect2PacketWriter(std::filesystem::path folder) : folder_(std::move(folder)) {
  require_writable_folder(folder_);
}

bool Kinect2PacketWriter::onNewFrame(DeviceFrame::Type type, DeviceFrame* frame) {
  constexpr bool kTakesOwnership = false;  // return value: libfreenect2 keeps the frame
  const std::lock_guard lock(mutex_);
  try {
    if (type == DeviceFrame::Depth) {
      write(*frame, ".depth");
      count(written_.depth, last_depth_, frame->sequence);
    } else if (type == DeviceFrame::Color) {
      write(*frame, ".jpg");
      count(written_.color, last_color_, frame->sequence);
    }
  } catch (const InputError& error) {
    if (error_.empty()) error_ = error.what();
  }
  return kTakesOwnership;
}

void Kinect2PacketWriter::write(const DeviceFrame& frame, const char* ending) {
  const auto file = folder_ / fmt::format("{}_packet_{}{}", frame.timestamp, frame.sequence, ending);
  // For a raw frame this is its total size.
  // Not flushed one by one: this is a callback of the USB threads.
  write_file(file, std::string_view(reinterpret_cast<const char*>(frame.data), frame.bytes_per_pixel),
             Durability::kWithTheOthers);
}

void Kinect2PacketWriter::count(size_t& packets, std::optional<uint32_t>& last, uint32_t number) {
  ++packets;
  if (last && number > *last) written_.lost += number - *last - 1;
  last = number;
}

RawPacketCounts Kinect2PacketWriter::written() const {
  const std::lock_guard lock(mutex_);
  if (!error_.empty()) throw InputError(error_);
  return written_;
}

RawPacketCounts record_packets(Kinect2Handle handle, const KinectOptions& options,
                               const std::filesystem::path& folder,
                               const std::function<bool(const RawPacketCounts&)>& should_stop) {
  constexpr std::chrono::milliseconds kBetweenLooks(10), kFrameTimeout(1000);
  Kinect2PacketWriter writer(folder);
  const ClosedAtEnd closed_at_end(handle);  // before the writer goes, which the device's threads call
  start_kinect2(handle, writer, options);
  const auto infrared = handle.device->getIrCameraParams();
  const auto color = handle.device->getColorCameraParams();
  write_file(folder / "parameters.yaml", parameters_text(infrared, color));
  write_camera_file(folder / "camera.yaml", factory_camera(color, infrared));
  RawPacketCounts written = writer.written();
  auto last_news = Clock::now();
  while (!should_stop(written) && Clock::now() - last_news < kFrameTimeout) {
    std::this_thread::sleep_for(kBetweenLooks);
    const RawPacketCounts now = writer.written();
    if (packets(now) > packets(written)) last_news = Clock::now();
    written = now;
  }
  if (!should_stop(written))
    log::warn("kinect2: no more packets; the camera may be unplugged. Finishing the recording");
  close_kinect2(handle);
  flush_files(folder);
  return writer.written();
}

RawPacketCounts record_kinect2_raw(const KinectOptions& options, const std::filesystem::path& folder,
                                   const std::function<bool(const RawPacketCounts&)>& should_stop) {
  libfreenect2::DumpPacketPipeline* pipeline = nullptr;  // owned by the device
  const Kinect2Handle handle =
      open_kinect2_device(options, [&] { return pipeline = new libfreenect2::DumpPacketPipeline; });
  bool tables_written = false;
  return record_packets(handle, options, folder, [&](const RawPacketCounts& recording) {
    // The tables are available once the device has started.
    if (!tables_written) write_tables(folder, *pipeline);
    tables_written = true;
    return should_stop(recording);
  });
}

}  // namespace kinloop

#else

namespace kinloop {

RawPacketCounts record_kinect2_raw(const KinectOptions&, const std::filesystem::path&,
                                   const std::function<bool(const RawPacketCounts&)>&) {
  throw UsageError(
      "kinect2: not supported by this build; install libfreenect2 and rebuild (docs/cameras.md)");
}

}  // namespace kinloop

#endif
