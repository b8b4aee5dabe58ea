#include "session/source/open_frame_source.hpp"

#include <gmock/gmock.h>

#include "drivers/kinect1/kinect1_source.hpp"
#include "drivers/kinect2/kinect2_source.hpp"
#include "drivers/oak/oak_source.hpp"
#include "drivers/openni2/openni2_source.hpp"
#include "drivers/orbbec/orbbec_source.hpp"
#include "drivers/realsense/realsense_source.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::unique_ptr<FrameSource> open_named(const std::string& name) {
  SourceRequest request;
  request.sequence = name;
  return open_frame_source(request);
}

// Where the library is in the build, opening would start a camera that happens to be connected.
TEST(OpenFrameSource, LiveCamerasAreKnownByNameAlsoInABuildWithoutTheirLibrary) {
  const struct {
    const char* name;
    bool available;
    const char* library;
  } cameras[] = {
      {"kinect1", kinect1_available(), "libfreenect"}, {"kinect2", kinect2_available(), "libfreenect2"},
      {"openni2", openni2_available(), "libopenni2"},  {"realsense", realsense_available(), "librealsense2"},
      {"orbbec", orbbec_available(), "OrbbecSDK 2"},   {"oak", oak_available(), "depthai 3"}};
  for (const auto& camera : cameras) {
    EXPECT_EQ(source_kind(camera.name), SourceKind::kLive);
    if (camera.available) continue;
    EXPECT_THAT(test::usage_error([&] { open_named(camera.name); }),
                AllOf(StartsWith(std::string(camera.name) + ": not supported by this build"),
                      HasSubstr(std::string("install ") + camera.library)));
  }
}

TEST(OpenFrameSource, TellsSourcesApartByName) {
  for (const char* name : {"-", "unix:/tmp/frames", "oak"})
    EXPECT_EQ(source_kind(name), SourceKind::kLive) << name;
  for (const char* name : {"sim:room", "a.mkv", "oak.mkv", "b.oni", "c.bag", "d.mcap", "e.db3"})
    EXPECT_EQ(source_kind(name), SourceKind::kRecording) << name;
  for (const char* name : {"kinect3", "Oak", "mkv", "folder", "a.mkv.txt", "room.sens"})
    EXPECT_EQ(source_kind(name), SourceKind::kFolder) << name;
}

TEST(OpenFrameSource, ARecordingThatIsMissingIsNamed) {
  const test::TempFolder folder;
  for (const char* name : {"a.mkv", "b.oni", "c.bag"}) {
    const std::string path = (folder.path() / name).string();
    EXPECT_EQ(test::input_error([&] { open_named(path); }), path + ": no such file; check the path");
  }
}

TEST(OpenFrameSource, TheDepthSensorIsThatWhichTheUserNames) {
  SourceRequest request;
  request.sequence = "sim:room";
  request.simulation.frames = 1;
  CameraOptions options;
  options.sensor = "kinect2";
  set_camera(request, options);
  const auto source = open_frame_source(request);
  EXPECT_EQ(source->camera().sensor.model, DepthSensorModel::kKinect2);
  EXPECT_EQ(source->camera().sensor.origin, SensorOrigin::kCameraFile);
  EXPECT_TRUE(source->next());
  options.sensor = "kinect";
  EXPECT_THAT(test::usage_error([&] { set_camera(request, options); }),
              HasSubstr("'kinect' is no depth sensor"));
}

TEST(OpenFrameSource, TheSimulationTakesNoOtherCamera) {
  SourceRequest request;
  request.sequence = "sim:room";
  request.camera = "freiburg1";
  EXPECT_THAT(test::usage_error([&] { open_frame_source(request); }), HasSubstr("--camera"));
}

}  // namespace
}  // namespace kinloop
