// The server with valid and malicious clients.

#include <atomic>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

#include <gmock/gmock.h>
#include <libdeflate.h>
#include <sys/resource.h>

#include "kinloop/core/errors.hpp"
#include "tests/viewer/raw_client.hpp"
#include "viewer/server/service.hpp"

namespace kinloop::test {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Serves a scene that the test modifies.
class Served {
 public:
  explicit Served(const std::string& listen = "0")
      : service_(
            parse_listen_address(listen), [this](Scene& scene, size_t) { update(scene); },
            [this](const Command& command) {
              const std::lock_guard lock(mutex_);
              commands_.push_back(command);
            }) {}

  void put(PartKind kind, uint32_t index, WireBytes body) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({kind, index, 0, std::make_shared<const WireBytes>(std::move(body))});
  }
  std::vector<Command> commands() {
    const std::lock_guard lock(mutex_);
    return commands_;
  }
  [[nodiscard]] std::string run() {
    const std::lock_guard lock(mutex_);
    return run_;
  }
  [[nodiscard]] int port() const { return port_of(service_.url()); }
  [[nodiscard]] const std::string& url() const { return service_.url(); }
  [[nodiscard]] std::string token() const { return url().substr(url().find("token=") + 6); }
  /// The feed of a browser that opened the printed URL.
  [[nodiscard]] std::string feed() const { return "/feed?token=" + token(); }
  [[nodiscard]] size_t browsers() const { return service_.browsers(); }
  [[nodiscard]] bool wait_until_sent(int most_ms) const {
    return service_.wait_until_sent(std::chrono::milliseconds(most_ms));
  }

 private:
  void update(Scene& scene) {
    const std::lock_guard lock(mutex_);
    run_ = scene.run();
    for (const ScenePart& part : std::exchange(waiting_, {})) scene.put(part.kind, part.index, *part.body);
  }

  std::mutex mutex_;
  std::string run_;
  std::vector<ScenePart> waiting_;
  std::vector<Command> commands_;
  ViewerService service_;
};

/// Polls for a condition, some seconds at most.
template <class Question>
bool becomes(const Question& question) {
  for (int i = 0; i < 1000 && !question(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return question();
}

TEST(ViewerServer, PageForbidsExternalContent) {
  const Served served;
  const std::string answer = RawClient(served.port()).get("/");
  EXPECT_THAT(answer, AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("</html>")));
  EXPECT_THAT(answer, HasSubstr("default-src 'none'"));
  EXPECT_THAT(answer, HasSubstr("frame-ancestors 'none'"));
  EXPECT_THAT(answer, HasSubstr("Referrer-Policy: no-referrer"));
}

TEST(ViewerServer, HasNoFilesToReach) {
  const Served served;
  for (const char* target : {"/../../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd",
                             "/etc/passwd", "/feed/../../etc/passwd", "/..\\..\\etc\\passwd", "/index.html",
                             "/feed", "file:///etc/passwd", "http://localhost/etc/passwd", "*"}) {
    const std::string answer = RawClient(served.port()).get(target);
    EXPECT_THAT(answer, AnyOf(StartsWith("HTTP/1.1 404"), "")) << target;
    EXPECT_THAT(answer, Not(HasSubstr("root:"))) << target;
  }
}

TEST(ViewerServer, TakesNothingButShortGetRequests) {
  const Served served;
  const auto answer_to = [&](const std::string& bytes) {
    RawClient client(served.port());
    client.send(bytes);
    return client.read_all();
  };
  EXPECT_THAT(answer_to("DELETE / HTTP/1.1\r\nHost: localhost\r\n\r\n"), StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(answer_to("GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(100'000, 'x') + "\r\n\r\n"),
              AnyOf(StartsWith("HTTP/1.1 431"), ""));
  EXPECT_THAT(answer_to("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999\r\n\r\nxxx"),
              Not(StartsWith("HTTP/1.1 200")));
  EXPECT_EQ(answer_to(std::string(1000, '\0') + "\r\n\r\n"), "");
  EXPECT_EQ(answer_to("\x16\x03\x01\x02\r\n\r\n"), "");  // TLS
  EXPECT_THAT(RawClient(served.port()).get("/"), StartsWith("HTTP/1.1 200"));
}

TEST(ViewerServer, RejectsForeignOriginsAndDnsRebinding) {
  const Served served;
  EXPECT_THAT(RawClient(served.port()).get("/", "", "evil.example"), StartsWith("HTTP/1.1 403"));
  EXPECT_FALSE(RawClient(served.port()).open_feed("/feed", "Origin: http://evil.example\r\n"));
  EXPECT_FALSE(RawClient(served.port()).open_feed("/feed", "Origin: null\r\n"));
  EXPECT_TRUE(RawClient(served.port()).open_feed("/feed", "Origin: http://localhost\r\n"));
}

TEST(ViewerServer, OnOtherAddressesTheTokenOfTheUrlIsNeeded) {
  const Served served("0.0.0.0:0");
  const std::string token = served.token();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_THAT(RawClient(served.port()).get("/"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(RawClient(served.port()).get("/?token=" + std::string(32, '0')), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(RawClient(served.port()).get("/?token=" + token, "", "robot"), StartsWith("HTTP/1.1 200"));
  EXPECT_FALSE(RawClient(served.port()).open_feed("/feed?token=" + token.substr(1)));
  EXPECT_TRUE(RawClient(served.port()).open_feed("/feed?token=" + token));
}

TEST(ViewerServer, SendsEveryPartAndAfterABreakOnlyTheRest) {
  Served served;
  for (uint8_t i = 0; i < 3; ++i) served.put(PartKind::kCloud, i, {i});
  double seen = 0;
  {
    RawClient client(served.port());
    ASSERT_TRUE(client.open_feed());
    for (int i = 0; i < 3; ++i) {
      const auto part = client.next_part();
      ASSERT_TRUE(part);
      EXPECT_EQ(part->body, std::string(1, static_cast<char>(i)));
      seen = part->version;
    }
  }
  served.put(PartKind::kCloud, 1, {9});
  const std::string since = std::to_string(static_cast<uint64_t>(seen));
  RawClient back(served.port()), stranger(served.port());
  ASSERT_TRUE(back.open_feed("/feed?run=" + served.run() + "&since=" + since));
  const auto rest = back.next_part();
  ASSERT_TRUE(rest);
  EXPECT_EQ(rest->index, 1U);
  EXPECT_EQ(rest->body, "\x09");
  ASSERT_TRUE(stranger.open_feed("/feed?run=another&since=" + since));  // of an earlier run
  EXPECT_EQ(stranger.next_part()->index, 0U);
}

/// Of `bytes` bytes that repeat nowhere near a piece's length.
WireBytes large_body(size_t bytes, uint8_t seed) {
  constexpr size_t kPeriod = 251;
  WireBytes body(bytes);
  for (size_t i = 0; i < bytes; ++i) body[i] = static_cast<uint8_t>((i + seed) % kPeriod);
  return body;
}

std::string text_of(const WireBytes& bytes) {
  return {bytes.begin(), bytes.end()};
}

TEST(ViewerServer, ALargePartComesInPiecesOfAtMostOneMib) {
  constexpr size_t kMib = size_t{1} << 20;
  Served served;
  const WireBytes mesh = large_body(3 * kMib + 7, 0);
  served.put(PartKind::kMesh, 5, mesh);
  served.put(PartKind::kLoops, 0, {});
  RawClient client(served.port());
  ASSERT_TRUE(client.open_feed());
  std::string body;
  while (body.size() < mesh.size()) {
    const auto piece = client.next_piece();
    ASSERT_TRUE(piece);
    EXPECT_EQ(piece->kind, static_cast<uint32_t>(PartKind::kMesh));
    EXPECT_EQ(piece->index, 5U);
    EXPECT_EQ(piece->body_bytes, static_cast<double>(mesh.size()));
    EXPECT_EQ(piece->offset_bytes, static_cast<double>(body.size()));
    EXPECT_LE(piece->body.size(), kMib);
    body += piece->body;
  }
  EXPECT_EQ(body, text_of(mesh));
  EXPECT_EQ(client.next_part()->kind, static_cast<uint32_t>(PartKind::kLoops)) << "a part without a body";
}

TEST(ViewerServer, ContinuesAPartWhereTheConnectionHasBroken) {
  constexpr size_t kBytes = 1'000'000;
  Served served;
  const WireBytes mesh = large_body(kBytes, 0), newer = large_body(kBytes, 1);
  served.put(PartKind::kMesh, 0, mesh);
  std::string received;
  double version = 0;
  {
    RawClient client(served.port());
    ASSERT_TRUE(client.open_feed());
    for (int i = 0; i < 2; ++i) {
      const auto piece = client.next_piece();
      ASSERT_TRUE(piece);
      received += piece->body;
      version = piece->version;
    }
  }
  const auto rest_after = [&](const std::string& bytes) {
    RawClient client(served.port());
    EXPECT_TRUE(client.open_feed("/feed?run=" + served.run() + "&since=0&bytes=" + bytes +
                                 "&part=" + std::to_string(static_cast<uint64_t>(version))));
    return client.next_part().value_or(ReceivedPart{});
  };
  const ReceivedPart rest = rest_after(std::to_string(received.size()));
  EXPECT_EQ(rest.offset_bytes, static_cast<double>(received.size()));
  EXPECT_EQ(received + rest.body, text_of(mesh));
  for (const char* nonsense : {"1000000", "18446744073709551615", "99999999999999999999999", "-1", ""})
    EXPECT_EQ(rest_after(nonsense).body, text_of(mesh)) << nonsense;

  served.put(PartKind::kMesh, 0, newer);  // what has come of the old one is of no use
  EXPECT_TRUE(becomes([&] { return rest_after(std::to_string(received.size())).version > version; }));
  EXPECT_EQ(rest_after(std::to_string(received.size())).body, text_of(newer));
}

TEST(ViewerServer, ThePageIsCompressedForBrowsersThatAcceptIt) {
  const Served served;
  const std::string plain = RawClient(served.port()).get("/");
  const std::string gzip = RawClient(served.port()).get("/", "Accept-Encoding: gzip, deflate, br\r\n");
  EXPECT_THAT(plain, Not(HasSubstr("Content-Encoding")));
  EXPECT_THAT(gzip, AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("Content-Encoding: gzip")));
  const auto body_of = [](const std::string& answer) { return answer.substr(answer.find("\r\n\r\n") + 4); };
  const std::string page = body_of(plain), packed = body_of(gzip);
  std::string unpacked(page.size(), '\0');
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  EXPECT_EQ(libdeflate_gzip_decompress(decompressor.get(), packed.data(), packed.size(), unpacked.data(),
                                       unpacked.size(), nullptr),
            LIBDEFLATE_SUCCESS);
  EXPECT_EQ(unpacked, page);
  for (const char* refusal : {"gzip;q=0", "identity", "br", ",;,"}) {
    const std::string answer =
        RawClient(served.port()).get("/", "Accept-Encoding: " + std::string(refusal) + "\r\n");
    EXPECT_EQ(body_of(answer), page) << refusal;
  }
}

std::string command_frame(const std::string& name) {
  return text_frame("{\"command\":\"" + name + "\"}");
}

TEST(ViewerServer, DispatchesCommands) {
  Served served;
  RawClient client(served.port());
  ASSERT_TRUE(client.open_feed(served.feed()));
  for (const char* name : {"pause", "step", "resume", "save"}) client.send(command_frame(name));
  EXPECT_TRUE(becomes([&] { return served.commands().size() == 4; }));
  EXPECT_THAT(served.commands(), ElementsAre(Command{CommandKind::kPause}, Command{CommandKind::kStep},
                                             Command{CommandKind::kResume}, Command{CommandKind::kSave}));
}

TEST(ViewerServer, DispatchesTheLoopToBeWithdrawn) {
  Served served;
  RawClient client(served.port());
  ASSERT_TRUE(client.open_feed(served.feed()));
  client.send(text_frame(R"({"command": "withdraw", "loop": "12.3,45.6"})"));
  EXPECT_TRUE(becomes([&] { return served.commands().size() == 1; }));
  EXPECT_THAT(served.commands(), ElementsAre(Command{CommandKind::kWithdrawLoop, "12.3,45.6"}));
}

TEST(ViewerServer, OtherUsersOfTheMachineMayLookButNotControl) {
  Served served;
  served.put(PartKind::kStatus, 0, {7});
  for (const std::string& feed : {std::string("/feed"), "/feed?token=" + std::string(32, '0')}) {
    RawClient client(served.port());
    ASSERT_TRUE(client.open_feed(feed));
    ASSERT_TRUE(client.next_part());
    client.send(command_frame("pause"));
    EXPECT_TRUE(client.receives("Open the URL that kinloop printed")) << feed;
  }
  EXPECT_TRUE(served.commands().empty());
}

TEST(ViewerServer, ABrowserThatSendsTooManyCommandsIsDisconnected) {
  Served served;
  RawClient client(served.port());
  ASSERT_TRUE(client.open_feed(served.feed()));
  for (int i = 0; i < 1000; ++i) client.send(command_frame("save"));
  EXPECT_TRUE(client.receives("Too many commands"));
  EXPECT_GE(served.commands().size(), 100U);
  EXPECT_LT(served.commands().size(), 1000U);
}

TEST(CommandRate, AllowsAHundredAtOnceAndTwentyASecond) {
  CommandRate rate;
  std::chrono::steady_clock::time_point now{std::chrono::hours(1)};
  const auto allowed = [&](int asked) {
    int count = 0;
    for (int i = 0; i < asked; ++i) count += rate.allows(now);
    return count;
  };
  EXPECT_EQ(allowed(200), 100);
  now += std::chrono::seconds(1);
  EXPECT_EQ(allowed(200), 20);
  now += std::chrono::hours(1);
  EXPECT_EQ(allowed(200), 100);
}

TEST(ViewerServer, DropsBrowsersThatSendAnythingElse) {
  Served served;
  const std::string masked_2_gib = std::string("\x82\xff\0\0\0\0\x80\0\0\0", 10) + std::string(4, '\0');
  const std::string bad[] = {text_frame("{\"command\":\"shutdown\"}"),
                             text_frame("{\"command\":7}"),
                             text_frame("[]"),
                             text_frame("\xff\xfe"),
                             text_frame(""),
                             masked_2_gib,
                             "\x81\x05hello",                     // not masked
                             std::string("\x8f\x80\0\0\0\0", 6),  // no such opcode
                             std::string("\xc1\x80\0\0\0\0", 6),  // an extension that was not negotiated
                             std::string("\x89\xfe\x01\x00\0\0\0\0", 8),  // a ping that is too long
                             std::string("\x80\x80\0\0\0\0", 6),  // a continuation without a beginning
                             std::string(5000, 'x')};
  for (const std::string& bytes : bad) {
    RawClient client(served.port());
    ASSERT_TRUE(client.open_feed(served.feed()));
    client.send(bytes);
    EXPECT_TRUE(client.is_closed()) << bytes.substr(0, 30);
  }
  EXPECT_TRUE(served.commands().empty());
  EXPECT_TRUE(becomes([&] { return served.browsers() == 0; }));
  EXPECT_TRUE(RawClient(served.port()).open_feed());
}

TEST(ViewerServer, EmptyFragmentsAndPingsAreReadSlowly) {
  constexpr size_t kFlood = 64'000'000;
  const std::string first("\x01\x80\0\0\0\0", 6), next("\x00\x80\0\0\0\0", 6), ping("\x89\x80\0\0\0\0", 6);
  Served served;
  served.put(PartKind::kStatus, 0, {7});
  for (const std::string& frame : {next, ping}) {
    std::string frames = first;
    while (frames.size() < kFlood) frames += frame;
    RawClient client(served.port());
    ASSERT_TRUE(client.open_feed());
    EXPECT_LT(client.flood(frames), kFlood / 2) << "the buffers of both ends hold a few MB";
    RawClient other(served.port());
    ASSERT_TRUE(other.open_feed());
    EXPECT_TRUE(other.next_part());
  }
}

double resident_mib() {
  constexpr double kPagesPerMib = 256;
  std::ifstream statm("/proc/self/statm");
  double all = 0, resident = 0;
  statm >> all >> resident;
  return resident / kPagesPerMib;
}

TEST(ViewerServer, AStalledBrowserDoesNotBlockOthers) {
  Served served;
  std::vector<RawClient> stalled;
  for (int i = 0; i < 3; ++i) {
    stalled.emplace_back(served.port());
    ASSERT_TRUE(stalled.back().open_feed());
  }
  RawClient reader(served.port());
  ASSERT_TRUE(reader.open_feed());
  constexpr size_t kMib = size_t{1} << 20;
  constexpr uint8_t kRounds = 60, kParts = 16;
  const double before_mib = resident_mib();
  for (uint8_t round = 1; round <= kRounds; ++round) {
    for (uint8_t i = 0; i < kParts; ++i) served.put(PartKind::kCloud, i, WireBytes(kMib, round));
    served.put(PartKind::kStatus, 0, {round});
    while (true) {  // the reader gets this round while the others are stalled
      const auto part = reader.next_part();
      ASSERT_TRUE(part);
      if (part->kind == static_cast<uint32_t>(PartKind::kStatus) && part->body[0] == static_cast<char>(round))
        break;
    }
  }
  // Nearly a GiB was sent; only one scene and, per stalled browser, one part is held in memory (plus the
  // sanitizers' overhead).
  EXPECT_LT(resident_mib() - before_mib, 400);
}

TEST(ViewerServer, WaitsUntilBrowsersHaveBeenSentEverything) {
  constexpr int kLong_ms = 10'000, kShort_ms = 300;
  Served served;
  EXPECT_TRUE(served.wait_until_sent(kLong_ms)) << "nobody is there";
  RawClient browser(served.port());
  ASSERT_TRUE(browser.open_feed());
  served.put(PartKind::kStatus, 0, {1, 2, 3});
  EXPECT_TRUE(served.wait_until_sent(kLong_ms));
  const auto part = browser.next_part();
  ASSERT_TRUE(part);
  EXPECT_EQ(part->body, "\1\2\3");
  served.put(PartKind::kMesh, 0, WireBytes(20'000'000));
  ASSERT_TRUE(browser.next_piece()) << "it has begun to come";
  EXPECT_FALSE(served.wait_until_sent(kShort_ms)) << "the browser does not read on";
}

TEST(ViewerServer, IdleConnectionsAreLimited) {
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
  constexpr size_t kIdle = 1000;
  if (files.rlim_cur < 2 * kIdle) GTEST_SKIP() << "fewer than 2000 file descriptors may be open";

  Served served;
  RawClient friendly(served.port());
  ASSERT_TRUE(friendly.open_feed());
  std::vector<RawClient> idle;
  for (size_t i = 0; i < kIdle; ++i) idle.emplace_back(served.port());
  const auto descriptors = [] {
    const std::filesystem::directory_iterator open("/proc/self/fd");
    return static_cast<size_t>(std::distance(begin(open), end(open)));
  };
  // The test's own for the idle ones, and the server's for its limit.
  EXPECT_TRUE(becomes([&] { return descriptors() < kIdle + 150; })) << descriptors();
  served.put(PartKind::kStatus, 0, {7});
  const auto part = friendly.next_part();
  ASSERT_TRUE(part);
  EXPECT_EQ(part->body, "\x07");
  idle.clear();
  EXPECT_TRUE(becomes([&] { return RawClient(served.port()).get("/").starts_with("HTTP/1.1 200"); }));
}

TEST(ViewerServer, SilentAndSlowConnectionsLockNobodyOut) {
  const Served served;
  std::vector<RawClient> others;
  for (size_t i = 0; i < 200; ++i) {
    others.emplace_back(served.port());
    if (i % 2 == 0) others.back().send("GET / HT");
  }
  EXPECT_THAT(RawClient(served.port()).get("/"), StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(RawClient(served.port()).open_feed(served.feed()));
}

TEST(ViewerServer, SpectatorsLeavePlacesForThoseWithTheToken) {
  const Served served;
  std::vector<RawClient> browsers;
  const auto opens = [&](const std::string& feed) {
    browsers.emplace_back(served.port());
    return browsers.back().open_feed(feed);
  };
  for (int i = 0; i < 16; ++i) ASSERT_TRUE(opens("/feed")) << i;
  EXPECT_FALSE(opens("/feed"));
  for (int i = 0; i < 16; ++i) EXPECT_TRUE(opens(served.feed())) << i;
  EXPECT_FALSE(opens(served.feed()));
}

TEST(ViewerServer, SaysThatThePortIsTaken) {
  const Served served;
  try {
    const Served second(std::to_string(served.port()));
    FAIL() << "two servers on one port";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--viewer PORT"));
  }
}

}  // namespace
}  // namespace kinloop::test
