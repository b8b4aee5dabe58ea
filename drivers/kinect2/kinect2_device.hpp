#pragma once
// In: which Kinect 2. Out: libfreenect2's device. Needs its headers: for the Kinect 2's own files and their
// tests only.

#include <functional>
#include <memory>

#include <libfreenect2/libfreenect2.hpp>

#include "drivers/live/kinect_options.hpp"

namespace kinloop {

/// Sizes of a Kinect 2's images, px.
constexpr int kKinect2ColorWidth = 1920, kKinect2ColorHeight = 1080, kKinect2DepthWidth = 512,
              kKinect2DepthHeight = 424;

/// An open device and what must live as long as it; the context deletes the device.
struct Kinect2Handle {
  std::shared_ptr<void> context;
  libfreenect2::Freenect2Device* device = nullptr;
};

/// Makes what decodes packets; the device that it is made for deletes it.
using MakePipeline = std::function<libfreenect2::PacketPipeline*()>;

/// Opens the device that the options name, with the pipeline that they name or a given one. Throws InputError
/// where there is none.
Kinect2Handle open_kinect2_device(const KinectOptions& options, const MakePipeline& make_pipeline = {});

/// Starts its streams into `listener`. Throws InputError where it does not start.
void start_kinect2(const Kinect2Handle& handle, libfreenect2::FrameListener& listener,
                   const KinectOptions& options);

/// Stops and forgets it, where there is one.
void close_kinect2(Kinect2Handle& handle);

}  // namespace kinloop
