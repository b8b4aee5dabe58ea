#include "session/plan/sensor_memory.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/sensor/source/forwarding_source.hpp"
#include "session/session.hpp"
#include "simulator/simulated_source.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

RgbdCamera some_camera() {
  RgbdCamera camera;
  camera.color = {640, 480, 525, 525, 319.5, 239.5, {}};
  return camera;
}

/// The estimate of a run that found the readout time, but not the depth delay.
SensorEstimate readout_found(double readout_s, double sigma_s = 1e-3) {
  SensorEstimate estimate = nominal_estimate(make_sensor(some_camera()));
  estimate.sensor.corrections(kRollingShutter) = readout_s;
  estimate.sigma(kRollingShutter) = sigma_s;
  estimate.used[kRollingShutter] = true;
  return estimate;
}

class SensorMemoryTest : public testing::Test {
 protected:
  [[nodiscard]] std::optional<double> recalled_readout_s() const {
    return memory_.recall(some_camera()).rolling_shutter_s;
  }

  test::TempFolder folder_;
  SensorMemory memory_{folder_.path() / "sensors", "A00367A00000042A"};
};

TEST_F(SensorMemoryTest, TheNextRunBeginsWithWhatTheLastOneEstimated) {
  EXPECT_FALSE(recalled_readout_s()) << "nothing is remembered yet";
  memory_.remember(some_camera(), readout_found(0.027));
  EXPECT_EQ(memory_.file(), folder_.path() / "sensors" / "A00367A00000042A.yaml");
  ASSERT_TRUE(recalled_readout_s());
  EXPECT_NEAR(*recalled_readout_s(), 0.027, 1e-6);
  EXPECT_EQ(memory_.recall(some_camera()).depth_delay_s, 0) << "not estimated";
}

TEST_F(SensorMemoryTest, RunsAreMergedByTheirCovariances) {
  memory_.remember(some_camera(), readout_found(0.026, 2e-3));
  memory_.remember(some_camera(), readout_found(0.030, 1e-3));
  // The variances are 2 * 4 and 1.
  EXPECT_NEAR(*recalled_readout_s(), (0.026 / 8 + 0.030 / 1) / (1.0 / 8 + 1), 1e-6);
}

TEST_F(SensorMemoryTest, ARunThatEstimatedNothingChangesNothing) {
  const SensorEstimate nothing = nominal_estimate(make_sensor(some_camera()));
  memory_.remember(some_camera(), nothing);
  EXPECT_FALSE(std::filesystem::exists(memory_.file()));
  memory_.remember(some_camera(), readout_found(0.027));
  const std::string before = read_file(memory_.file());
  memory_.remember(some_camera(), nothing);
  EXPECT_EQ(read_file(memory_.file()), before);
}

TEST_F(SensorMemoryTest, WhatTheCalibrationStatesPrevails) {
  memory_.remember(some_camera(), readout_found(0.027));
  RgbdCamera global_shutter = some_camera();
  global_shutter.rolling_shutter_s = 0;
  EXPECT_EQ(memory_.recall(global_shutter).rolling_shutter_s, 0);
}

TEST_F(SensorMemoryTest, AnotherModeOfTheCameraIsAnotherSensor) {
  RgbdCamera fast = some_camera();
  fast.fps = 60;
  memory_.remember(some_camera(), readout_found(0.027));
  EXPECT_FALSE(memory_.recall(fast).rolling_shutter_s);
  memory_.remember(fast, readout_found(0.014));
  EXPECT_NEAR(*memory_.recall(fast).rolling_shutter_s, 0.014, 1e-6) << "not mixed with that of 30 Hz";
  EXPECT_FALSE(recalled_readout_s());
}

TEST_F(SensorMemoryTest, ADamagedFileIsIgnoredAndReplaced) {
  memory_.remember(some_camera(), readout_found(0.027));
  const std::string good = read_file(memory_.file());
  for (const char* damaged : {"", "width: [", "width: 640\n", "rolling_shutter_s: 7\n"}) {
    write_file(memory_.file(), damaged);
    EXPECT_FALSE(recalled_readout_s()) << damaged;
  }
  std::string impossible = good;
  impossible.replace(impossible.find("value: 0.027"), 12, "value: 7.027");
  write_file(memory_.file(), impossible);
  EXPECT_FALSE(recalled_readout_s());
  memory_.remember(some_camera(), readout_found(0.027));
  EXPECT_EQ(read_file(memory_.file()), good);
}

TEST_F(SensorMemoryTest, AFolderThatCannotBeWrittenEndsNothing) {
  write_file(folder_.path() / "file", "");
  const SensorMemory nowhere(folder_.path() / "file", "1");
  nowhere.remember(some_camera(), readout_found(0.027));
  EXPECT_FALSE(nowhere.recall(some_camera()).rolling_shutter_s);
}

TEST_F(SensorMemoryTest, ASerialNumberIsNoPath) {
  EXPECT_EQ(SensorMemory("sensors", "../12:3").file(), std::filesystem::path("sensors/___12_3.yaml"));
}

/// The environment as it was, at the end of a test.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~ScopedVariable() { before_ ? setenv(name_, before_->c_str(), 1) : unsetenv(name_); }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(SensorMemoryFolder, IsWhereTheUserKeepsData) {
  const ScopedVariable home("HOME", "/home/somebody");
  {
    const ScopedVariable data("XDG_DATA_HOME", "/data");
    EXPECT_EQ(sensor_memory_folder(), "/data/kinloop/sensors");
  }
  const ScopedVariable relative("XDG_DATA_HOME", "data");
  EXPECT_EQ(sensor_memory_folder(), "/home/somebody/.local/share/kinloop/sensors");
}

SourceInfo info_of(bool live, const std::string& serial) {
  SourceInfo info;
  info.live = live;
  info.serial = serial;
  return info;
}

TEST(SensorMemoryOf, OnlyALiveCameraWithASerialNumberHasOne) {
  const ScopedVariable home("HOME", "/home/somebody");
  EXPECT_TRUE(sensor_memory_of(info_of(true, "42")));
  EXPECT_FALSE(sensor_memory_of(info_of(false, "42"))) << "a recording";
  EXPECT_FALSE(sensor_memory_of(info_of(true, "")));
  EXPECT_FALSE(sensor_memory_of(info_of(true, "0000000000000000")));
}

/// The simulated camera as a live one.
class NumberedCamera : public ForwardingSource {
 public:
  explicit NumberedCamera(std::unique_ptr<FrameSource> source) : ForwardingSource(std::move(source)) {
    info_ = ForwardingSource::info();
    info_.live = true;
    info_.serial = "42";
    camera_ = ForwardingSource::camera();
    camera_.sensor = {};  // whose readout time nobody knows
  }
  std::optional<Frame> next() override { return source().next(); }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }

 private:
  SourceInfo info_;
  RgbdCamera camera_;
};

TEST(SensorMemoryOf, TheSecondRunWithALiveCameraKnowsItFromTheFirstFrame) {
  const test::TempFolder folder;
  const ScopedVariable data("XDG_DATA_HOME", folder.path().string());
  SimulationOptions simulation;
  simulation.frames = 120;
  simulation.width = 320, simulation.height = 240;
  NumberedCamera camera(make_simulated_source("sim:room", simulation, 2));
  const auto memory = sensor_memory_of(camera.info());
  ASSERT_TRUE(memory);
  Session session(camera, SessionOptions{});
  while (const auto frame = session.next()) session.process(*frame);
  session.finish();
  memory->remember(camera.camera(), session.slam().sensor_estimate());
  const auto readout_s = memory->recall(camera.camera()).rolling_shutter_s;
  ASSERT_TRUE(readout_s);
  EXPECT_NEAR(*readout_s, simulation.noise.rolling_shutter_s, 0.005);
}

}  // namespace
}  // namespace kinloop
