// Lines for a reader that is slow, absent or gone.

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "apps/live_poses/pose_sender.hpp"
#include "drivers/stream/socket_file.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;

class LinesToAReader : public testing::Test {
 protected:
  LinesToAReader() { std::signal(SIGPIPE, SIG_IGN); }  // as the program

  [[nodiscard]] std::string at(const char* name) const { return (folder_.path() / name).string(); }

  [[nodiscard]] Descriptor open_to_read(const char* name) const {
    return Descriptor(::open(at(name).c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  }

  [[nodiscard]] Descriptor connect_to(const char* name) const {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, at(name).c_str());
    Descriptor reader(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(::connect(reader.number(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    return reader;
  }

  test::TempFolder folder_;
};

/// Returns all that can be read now.
std::string received(const Descriptor& reader) {
  std::string all;
  std::array<char, 4096> part{};
  ::fcntl(reader.number(), F_SETFL, O_NONBLOCK);
  for (ssize_t count = 0; (count = ::read(reader.number(), part.data(), part.size())) > 0;)
    all.append(part.data(), static_cast<size_t>(count));
  return all;
}

/// Lines of a length that does not divide the buffer of a pipe or a socket.
std::string numbered_line(int i) {
  return fmt::format("{:06} {}\n", i, std::string(900, 'x'));
}

/// Writes until a line is dropped, and returns how many were taken: a reader that does not read.
int fill(LineOutput& output) {
  constexpr int kMore = 100000;  // than any buffer holds
  for (int i = 0; i < kMore; ++i) {
    if (!output.write(numbered_line(i))) return i;
  }
  return kMore;
}

/// Expects lines 0 to `count` - 1, whole, after some lines were dropped, and the ones after them.
void expect_whole_lines(LineOutput& output, const Descriptor& reader, int count) {
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(output.write("dropped\n"));
  std::string expected;
  for (int i = 0; i < count; ++i) expected += numbered_line(i);
  std::string all = received(reader);
  EXPECT_TRUE(output.write("after\n"));  // and what was still to be sent of the last line before it
  all += received(reader);
  EXPECT_EQ(all, expected + "after\n");
}

/// Lets a reader that does not read come and go, and another one come: no line waits for them. The output
/// holds fewer than `max_lines`.
template <class OpenReader>
void expect_to_wait_for_nobody(LineOutput& output, int max_lines, const OpenReader& open_reader) {
  EXPECT_FALSE(output.write("nobody reads\n"));
  {
    const Descriptor reader = open_reader();
    const int taken = fill(output);
    EXPECT_GT(taken, 10);
    EXPECT_LT(taken, max_lines);
    expect_whole_lines(output, reader, taken);
  }
  EXPECT_FALSE(output.write("the reader is gone\n"));
  const Descriptor next = open_reader();
  EXPECT_TRUE(output.write("another\n"));
  EXPECT_EQ(received(next), "another\n");
}

TEST_F(LinesToAReader, OfAPipeWaitForNobody) {
  ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
  const auto output = open_line_output(at("pipe"));
  expect_to_wait_for_nobody(*output, 1000, [&] { return open_to_read("pipe"); });
}

TEST_F(LinesToAReader, OfASocketWaitForNobody) {
  const auto output = open_line_output("unix:" + at("socket"));
  expect_to_wait_for_nobody(*output, 10000, [&] { return connect_to("socket"); });
}

TEST_F(LinesToAReader, TheNextReaderMissesNoLineWhenTheFirstOneGoes) {
  const auto output = open_line_output("unix:" + at("socket"));
  auto first = std::make_unique<Descriptor>(connect_to("socket"));
  EXPECT_TRUE(output->write("1\n"));
  const Descriptor second = connect_to("socket");
  EXPECT_TRUE(output->write("2\n"));
  EXPECT_EQ(received(*first), "1\n2\n");
  first.reset();
  EXPECT_TRUE(output->write("3\n"));
  EXPECT_EQ(received(second), "3\n");
}

TEST_F(LinesToAReader, TheSocketIsRemovedAndNoOtherFileIsReplaced) {
  { const auto output = open_line_output("unix:" + at("socket")); }
  EXPECT_FALSE(std::filesystem::exists(at("socket")));
  folder_.write("file", "content");
  EXPECT_THAT(test::input_error([&] { open_line_output("unix:" + at("file")); }),
              HasSubstr("choose another path"));
  EXPECT_EQ(read_file(at("file")), "content");
}

TEST_F(LinesToAReader, GoByDatagrams) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const Descriptor reader(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ASSERT_EQ(::bind(reader.number(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  socklen_t size = sizeof(address);
  ::getsockname(reader.number(), reinterpret_cast<sockaddr*>(&address), &size);
  const auto output = open_line_output(fmt::format("udp:localhost:{}", ntohs(address.sin_port)));
  EXPECT_TRUE(output->write("one\n"));
  EXPECT_TRUE(output->write("two\n"));
  std::array<char, 16> datagram{};
  EXPECT_EQ(::recv(reader.number(), datagram.data(), datagram.size(), 0), 4);
  EXPECT_EQ(std::string(datagram.data(), 4), "one\n");
}

TEST_F(LinesToAReader, OfAFileAreThereAtOnceAndReplaceOlderOnes) {
  folder_.write("poses.jsonl", "old\n");
  for (const char* name : {"poses.jsonl", "new/poses.jsonl"}) {
    const auto output = open_line_output(at(name));
    EXPECT_TRUE(output->write("one\n"));
    EXPECT_EQ(read_file(at(name)), "one\n");
    EXPECT_TRUE(output->write("two\n"));
    EXPECT_EQ(read_file(at(name)), "one\ntwo\n");
  }
}

TEST_F(LinesToAReader, OfAFileAreWholeOrAbsentOnAFullDisk) {
  std::signal(SIGXFSZ, SIG_IGN);  // as the program
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{2000, before.rlim_max};  // two lines and a part
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto output = open_line_output(at("poses.jsonl"));
  EXPECT_TRUE(output->write(numbered_line(0)));
  EXPECT_TRUE(output->write(numbered_line(1)));
  EXPECT_FALSE(output->write(numbered_line(2)));
  EXPECT_EQ(output->error(), EFBIG);
  EXPECT_TRUE(output->write("short\n"));
  EXPECT_EQ(output->error(), 0);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(read_file(at("poses.jsonl")), numbered_line(0) + numbered_line(1) + "short\n");
}

TEST_F(LinesToAReader, OfASocketEndWithAWholeLine) {
  const auto output = open_line_output("unix:" + at("socket"));
  const Descriptor reader = connect_to("socket");
  const int taken = fill(*output);
  std::string all;
  std::thread slow([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    all = received(reader);
  });
  EXPECT_TRUE(output->finish());
  slow.join();
  all += received(reader);
  std::string expected;
  for (int i = 0; i < taken; ++i) expected += numbered_line(i);
  EXPECT_EQ(all, expected);
}

TEST_F(LinesToAReader, WrongTargetsAreErrorsThatSayWhatToGive) {
  for (const char* wrong : {"udp:", "udp:host", "udp:host:", "udp::5", "udp:host:0", "udp:host:65536",
                            "udp:host:5x", "udp:host:-1"})
    EXPECT_THAT(test::usage_error([&] { check_line_target(wrong); }), HasSubstr("udp:HOST:PORT")) << wrong;
  for (const char* right : {"udp:[::1]:5005", "udp:host:1", "-", "file", "unix:socket"})
    EXPECT_NO_THROW(check_line_target(right)) << right;
  EXPECT_THAT(test::input_error([&] { open_line_output(folder_.path().string()); }), HasSubstr("folder"));
  EXPECT_THAT(test::input_error([] { open_line_output("unix:"); }), HasSubstr("the path must have"));
}

TEST_F(LinesToAReader, StandardOutputIsRecognisedByItsNames) {
  EXPECT_TRUE(is_standard_output_target("-"));
  EXPECT_TRUE(is_standard_output_target("/dev/stdout"));
  EXPECT_FALSE(is_standard_output_target("/dev/stderr"));
  EXPECT_FALSE(is_standard_output_target("unix:/dev/stdout"));
  EXPECT_FALSE(is_standard_output_target(at("file")));
}

}  // namespace
}  // namespace kinloop
