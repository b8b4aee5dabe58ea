#include "drivers/stream/stream_source.hpp"

#include <array>
#include <atomic>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "drivers/datasets/tum_source.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "tests/drivers/message_writer.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;

std::string record(const std::string& header, const std::string& data = "") {
  const auto size = static_cast<uint32_t>(header.size());
  return std::string(reinterpret_cast<const char*>(&size), sizeof(size)) + header + data;
}

std::string start_record(const char* live = "false") {
  return record(
      fmt::format(R"({{"kinloop": 1, "live": {}, "camera": {{"width": 32, "height": 24, "fx": 25, "fy": 25,
      "cx": 15.5, "cy": 11.5, "distortion": [0, 0, 0, 0, 0], "depth_scale": 1000, "fps": 30}}}})",
                  live));
}

std::string frame_record(int64_t stamp_ns, const std::string& color_encoding, const std::string& color,
                         const std::string& depth_encoding, const std::string& depth,
                         const std::string& more = "") {
  return record(fmt::format(R"({{"stamp_ns": {}{}, "color": {{"encoding": "{}", "bytes": {}}},
                                "depth": {{"encoding": "{}", "bytes": {}}}}})",
                            stamp_ns, more, color_encoding, color.size(), depth_encoding, depth.size()),
                color + depth);
}

std::string png_frame(int64_t stamp_ns) {
  return frame_record(stamp_ns, "png", test::encoded(test::make_color(1), ".png"), "png",
                      test::encoded(test::make_depth(1000), ".png"));
}

/// A stream whose bytes are those of a file.
std::unique_ptr<FrameSource> stream_of(const test::TempFolder& folder, const std::string& bytes,
                                       const std::optional<RgbdCamera>& camera = {}) {
  const auto path = folder.write("stream", bytes);
  FILE* file = std::fopen(path.c_str(), "rb");
  ByteStream stream((Descriptor(::dup(fileno(file)))));
  std::fclose(file);
  std::filesystem::remove(path);
  return open_stream(std::move(stream), "test", camera);
}

size_t count_stream_frames(FrameSource& source) {
  size_t frames = 0;
  while (source.next()) ++frames;
  return frames;
}

TEST(StreamSource, ARawImageOfAnotherSizeIsRefusedWithTheNumbers) {
  const test::TempFolder folder;
  const cv::Mat color = test::make_color(1), depth = test::make_depth(1000);
  const std::string bgr = test::pixels_of(color), units = test::pixels_of(depth);
  const struct {
    std::string color, depth, bytes, expected;
  } cases[] = {
      {bgr + std::string(24 * 6, 'x'), units, "2448 bytes of bgr8", "are 2304"},  // rows with padding
      {bgr.substr(3), units, "2301 bytes of bgr8", "are 2304"},
      {bgr, units + units, "3072 bytes of 16UC1", "are 1536"}};
  for (const auto& [sent_color, sent_depth, bytes, expected] : cases) {
    const auto stream =
        stream_of(folder, start_record() + frame_record(100, "bgr8", sent_color, "16UC1", sent_depth));
    EXPECT_THAT(input_error([&] { stream->next(); }),
                AllOf(HasSubstr(bytes), HasSubstr("32 x 24 pixels"), HasSubstr(expected)));
  }
}

TEST(StreamSource, TheUnitOfDepthIsThatOfTheGivenCamera) {
  const test::TempFolder folder;
  RgbdCamera camera;
  camera.color.width = test::kWidth, camera.color.height = test::kHeight;
  camera.color.fx = camera.color.fy = 25;
  camera.depth_scale = 2000;
  const auto stream = stream_of(folder, start_record() + png_frame(100), camera);
  EXPECT_FLOAT_EQ(stream->next()->depth_m.at<float>(0, 0), 0.5F);
}

TEST(StreamSource, GivesTheFramesOfAFolderRawOrCompressed) {
  const test::SequenceFolder sequence(4);
  const test::TempFolder folder;
  for (const bool raw : {true, false}) {
    std::string bytes = start_record();
    TumSource source(sequence.path());
    while (const auto frame = source.next()) {
      cv::Mat depth;
      frame->depth_m.convertTo(depth, CV_16UC1, 1000);
      const auto encoded = [&](const cv::Mat& image) {
        return raw ? test::pixels_of(image) : test::encoded(image, ".png");
      };
      bytes += frame_record(frame->stamp_ns, raw ? "bgr8" : "png", encoded(frame->color.bgr()),
                            raw ? "16UC1" : "png", encoded(depth),
                            fmt::format(", \"depth_stamp_ns\": {}", *frame->depth_stamp_ns));
    }
    TumSource expected(sequence.path());
    const auto stream = stream_of(folder, bytes);
    EXPECT_EQ(stream->camera().color, expected.camera().color);
    EXPECT_FALSE(stream->info().live);
    while (const auto frame = expected.next()) {
      const auto sent = stream->next();
      ASSERT_TRUE(sent);
      EXPECT_EQ(sent->id, frame->id);
      EXPECT_EQ(sent->stamp_ns, frame->stamp_ns);
      EXPECT_EQ(sent->depth_stamp_ns, frame->depth_stamp_ns);
      EXPECT_EQ(cv::norm(sent->color.bgr(), frame->color.bgr(), cv::NORM_INF), 0);
      EXPECT_EQ(cv::norm(sent->depth_m, frame->depth_m, cv::NORM_INF), 0);
    }
    EXPECT_FALSE(stream->next());
    EXPECT_TRUE(stream->skipped().empty());
  }
}

/// The record of a frame with a mask.
std::string masked_frame(int64_t stamp_ns, const std::string& encoding, const std::string& mask) {
  const std::string more =
      fmt::format(R"(, "mask": {{"encoding": "{}", "bytes": {}}})", encoding, mask.size());
  return frame_record(stamp_ns, "png", test::encoded(test::make_color(1), ".png"), "png",
                      test::encoded(test::make_depth(1000), ".png"), more) +
         mask;
}

TEST(StreamSource, MasksComeWithTheFramesThatHaveOne) {
  cv::Mat mask = cv::Mat::ones(test::kHeight, test::kWidth, CV_8UC1);  // of labels: not 0 is used
  mask.colRange(0, 10) = 0;
  const test::TempFolder folder;
  const auto stream = stream_of(
      folder, start_record() + png_frame(100) + masked_frame(200, "png", test::encoded(mask, ".png")) +
                  masked_frame(300, "mono8", test::pixels_of(mask)) + png_frame(400));
  for (const bool masked : {false, true, true, false}) {
    const auto frame = stream->next();
    ASSERT_TRUE(frame);
    ASSERT_EQ(frame->mask.empty(), !masked);
    if (!masked) continue;
    EXPECT_EQ(cv::countNonZero(frame->mask != 255 * mask), 0);
  }
  EXPECT_FALSE(stream->next());
  EXPECT_TRUE(stream->skipped().empty());
}

TEST(StreamSource, FramesWhoseMaskCannotBeMeantAreSkippedAndCounted) {
  const test::TempFolder folder;
  const std::string mask =
                        test::encoded(cv::Mat(test::kHeight, test::kWidth, CV_8UC1, cv::Scalar(1)), ".png"),
                    small = test::encoded(cv::Mat(12, 16, CV_8UC1, cv::Scalar(1)), ".png"),
                    depth = test::encoded(test::make_depth(1000), ".png");
  const auto stream =
      stream_of(folder, start_record() + masked_frame(100, "png", small) +
                            masked_frame(200, "png", mask.substr(0, 40)) + masked_frame(300, "png", depth) +
                            masked_frame(400, "mono8", "short") + masked_frame(500, "jpeg", mask) +
                            masked_frame(600, "png", "") + masked_frame(700, "png", mask));
  const auto frame = stream->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->stamp_ns, 700);
  EXPECT_FALSE(stream->next());
  std::string reasons;
  for (const auto& skipped : stream->skipped()) reasons += skipped.reason + "\n";
  EXPECT_EQ(stream->skipped().size(), 6U);
  EXPECT_THAT(reasons, AllOf(HasSubstr("16 x 12"), HasSubstr("not an 8-bit grey PNG"), HasSubstr("5 bytes"),
                             HasSubstr("expected png or mono8"), HasSubstr("empty")));
}

TEST(StreamSource, AMaskThatIsAnnouncedButNotSentBreaksTheStream) {
  const test::TempFolder folder;
  const auto broken = [&](const std::string& more) {
    const auto stream = stream_of(folder, start_record() + frame_record(100, "bgr8", "", "16UC1", "", more));
    return input_error([&] { static_cast<void>(count_stream_frames(*stream)); });
  };
  EXPECT_THAT(broken(R"(, "mask": {"encoding": "png", "bytes": 9})"), HasSubstr("record 1"));
  EXPECT_THAT(broken(R"(, "mask": {"encoding": "png"})"), HasSubstr("the size of an image"));
  EXPECT_THAT(broken(R"(, "mask": null)"), HasSubstr("encoding"));
}

TEST(StreamSource, ALiveStreamDropsTheOldestFrames) {
  const test::TempFolder folder;
  std::string bytes = start_record("true");
  for (int i = 1; i <= 20; ++i) bytes += png_frame(i * 100);
  const auto stream = stream_of(folder, bytes);
  EXPECT_TRUE(stream->info().live);
  size_t frames = 0;
  int64_t last_ns = 0;
  while (const auto frame = stream->next()) ++frames, last_ns = frame->stamp_ns;
  EXPECT_EQ(last_ns, 2000);
  EXPECT_EQ(frames + stream->skipped().size(), 20U);
}

TEST(StreamSource, DamagedFramesAreSkippedAndCounted) {
  const test::TempFolder folder;
  const std::string color = test::encoded(test::make_color(1), ".png"),
                    depth = test::encoded(test::make_depth(1), ".png");
  const auto stream = stream_of(
      folder, start_record() + png_frame(100) + frame_record(200, "png", color.substr(0, 99), "png", depth) +
                  frame_record(300, "webp", color, "png", depth) +
                  frame_record(400, "bgr8", "short", "png", depth) +
                  frame_record(500, "png", color, "png", color) + png_frame(50) + png_frame(600));
  EXPECT_EQ(count_stream_frames(*stream), 2U);
  std::string reasons;
  for (const auto& skipped : stream->skipped()) reasons += skipped.reason + "\n";
  EXPECT_THAT(reasons, AllOf(HasSubstr("truncated"), HasSubstr("webp"), HasSubstr("16-bit"),
                             HasSubstr("does not increase")));
}

TEST(StreamSource, AMalformedStreamEndsAfterItsGoodFrames) {
  const test::TempFolder folder;
  const std::string good = start_record() + png_frame(100), next = png_frame(200);
  for (const std::string& bad :
       {next.substr(0, 2), next.substr(0, 20), next.substr(0, next.size() - 1), record("{"), record("[]"),
        record("{}"), std::string("\xff\xff\xff\x7f"), std::string(4, '\0'),
        record(R"({"stamp_ns": 1, "depth_stamp_ns": "later"})"),
        record(R"({"stamp_ns": 1, "color": {"encoding": "png", "bytes": 1e18}})"),
        record(R"({"stamp_ns": 1, "color": {"encoding": "png", "bytes": -5}})")}) {
    const auto stream = stream_of(folder, good + bad);
    EXPECT_TRUE(stream->next());
    EXPECT_THAT(input_error([&] { stream->next(); }),
                AllOf(HasSubstr("test: record 2"), HasSubstr("docs/protocol.md")));
  }
}

TEST(StreamSource, AStampIsAnIntegerInRange) {
  const test::TempFolder folder;
  for (const char* wrong : {"true", "1e300", "2.5", "-1e19", "18446744073709551615", "9223372036854775807",
                            "-9223372036854775808"}) {
    const std::string good = start_record() + png_frame(100);
    const std::string bad =
        record(fmt::format(R"({{"stamp_ns": {}, "color": {{"encoding": "bgr8", "bytes": 0}},
                                "depth": {{"encoding": "16UC1", "bytes": 0}}}})",
                           wrong));
    const auto stream = stream_of(folder, good + bad);
    EXPECT_TRUE(stream->next());
    EXPECT_THAT(input_error([&] { stream->next(); }),
                AllOf(HasSubstr("test: record 2"), HasSubstr("docs/protocol.md")));
  }
}

TEST(StreamSource, NamesWhatIsWrongWithTheStart) {
  const test::TempFolder folder;
  EXPECT_THAT(input_error([&] { stream_of(folder, ""); }), HasSubstr("empty"));
  EXPECT_THAT(input_error([&] { stream_of(folder, record("{}")); }), HasSubstr("\"kinloop\""));
  EXPECT_THAT(input_error([&] { stream_of(folder, record(R"({"kinloop": 9})")); }), HasSubstr("version 9"));
  EXPECT_THAT(input_error([&] { stream_of(folder, record(R"({"kinloop": 1})")); }), HasSubstr("--camera"));
  EXPECT_THAT(input_error([&] { stream_of(folder, record(R"({"kinloop": 1, "live": 3, "camera": {}})")); }),
              HasSubstr("wrong kind"));
  EXPECT_THAT(input_error([&] { stream_of(folder, record(R"({"kinloop": 1, "camera": {"width": 32}})")); }),
              HasSubstr("height"));
  EXPECT_THAT(input_error([&] { count_stream_frames(*stream_of(folder, start_record())); }),
              HasSubstr("no usable frame"));
}

TEST(StreamSource, ASocketIsCreatedAndRemoved) {
  const test::TempFolder folder;
  const auto path = folder.path() / "camera.sock";
  std::jthread sender([&] {
    while (!std::filesystem::is_socket(path)) std::this_thread::yield();
    const std::string command = fmt::format(
        "python3 -c \"import socket,sys; s=socket.socket(socket.AF_UNIX); s.connect('{}'); "
        "s.sendall(sys.stdin.buffer.read())\"",
        path.string());
    FILE* python = ::popen(command.c_str(), "w");
    const std::string bytes = start_record() + png_frame(100);
    std::fwrite(bytes.data(), 1, bytes.size(), python);
    ::pclose(python);
  });
  const auto stream = open_stream("unix:" + path.string(), {});
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_EQ(count_stream_frames(*stream), 1U);
  EXPECT_THAT(input_error([&] { open_stream("unix:" + std::string(200, 'x'), {}); }), HasSubstr("unix:"));
  EXPECT_THAT(input_error([&] { open_stream("unix:/nowhere/camera.sock", {}); }), HasSubstr("/nowhere"));
}

TEST(StreamSource, ASilentSenderIsNotWaitedForOnceStopped) {
  for (const char* live : {"true", "false"}) {
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe(pipe.data()), 0);
    const Descriptor sender(pipe[1]);
    const std::string bytes = start_record(live) + png_frame(100) + png_frame(200).substr(0, 50);
    ASSERT_EQ(::write(sender.number(), bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    std::atomic<bool> stop = false;
    const auto stream = open_stream(ByteStream(Descriptor(pipe[0])), "test", {}, [&] { return stop.load(); });
    EXPECT_TRUE(stream->next());
    stop = true;
    EXPECT_FALSE(stream->next()) << "half a frame is no error";
  }
}

TEST(StreamSource, StoppingBeforeTheFirstRecordIsAnError) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const Descriptor sender(pipe[1]);
  EXPECT_THAT(
      input_error([&] { open_stream(ByteStream(Descriptor(pipe[0])), "test", {}, [] { return true; }); }),
      HasSubstr("stopped"));
}

/// Binds a socket to `path`, as a run that was killed leaves it.
void leave_socket(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  const Descriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
  ASSERT_EQ(::bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
}

TEST(StreamSource, OnlyAbandonedSocketsAreReplaced) {
  const test::TempFolder folder;
  const auto path = folder.path() / "camera.sock";
  leave_socket(path);
  std::atomic<bool> stop = false;
  std::string stopped;
  std::jthread first(
      [&] { stopped = input_error([&] { accept_connection(path, [&] { return stop.load(); }); }); });
  struct stat file {};
  while (::stat(path.c_str(), &file) != 0 || (file.st_mode & 0777) != 0600) std::this_thread::yield();
  const auto open_second = [&] { open_stream("unix:" + path.string(), {}, [] { return true; }); };
  EXPECT_THAT(input_error(open_second), HasSubstr("choose another path"));
  EXPECT_TRUE(std::filesystem::is_socket(path));
  stop = true;
  first.join();
  EXPECT_THAT(stopped, HasSubstr("stopped before a program connected"));
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(StreamSource, NoMutatedStreamBreaksTheReader) {
  const test::TempFolder folder;
  const std::string raw = frame_record(200, "bgr8", test::pixels_of(test::make_color(1)), "16UC1",
                                       test::pixels_of(test::make_depth(9)));
  const std::string bytes = start_record() + png_frame(100) + raw;
  Random random(21);
  for (int i = test::mutations(2000); i > 0; --i) {
    try {
      count_stream_frames(*stream_of(folder, test::mutated(bytes, random)));
    } catch (const InputError& error) {
      EXPECT_THAT(std::string(error.what()), testing::Not(HasSubstr("\n")));
    }
  }
}

}  // namespace
}  // namespace kinloop
