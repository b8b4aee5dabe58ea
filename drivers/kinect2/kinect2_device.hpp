#pragma once
// In: the selection of a Kinect 2. Out: libfreenect2's device. Requires its headers; internal to the Kinect 2
// driver and its tests.

#include <functional>
#include <memory>

#include <libfreenect2/libfreenect2.hpp>

#include "drivers/live/kinect_options.hpp"

namespace kinloop {

/// Image sizes of a Kinect 2, px.
constexpr int kKinect2ColorWidth = 1920, kKinect2ColorHeight = 1080, kKinect2DepthWidth = 512,
              kKinect2DepthHeight = 424;

/// An open device and the objects that must outlive it; the context deletes the device.
struct Kinect2Handle {
  std::shared_ptr<void> context;
  libfreenect2::Freenect2Device* device = nullptr;
};

/// Creates the packet decoder; the device deletes it.
using MakePipeline = std::function<libfreenect2::PacketPipeline*()>;

/// Opens the device selected by the options, with the pipeline they select or the given one. Throws
/// InputError if there is none.
Kinect2Handle open_kinect2_device(const KinectOptions& options, const MakePipeline& make_pipeline = {});

/// Starts streaming into `listener`. Throws InputError on failure.
void start_kinect2(const Kinect2Handle& handle, libfreenect2::FrameListener& listener,
                   const KinectOptions& options);

/// Stops and releases the device, if any.
void close_kinect2(Kinect2Handle& handle);

}  // namespace kinloop
