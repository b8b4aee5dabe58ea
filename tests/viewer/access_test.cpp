#include "viewer/server/access.hpp"

#include <gtest/gtest.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

const AccessPolicy kHere{true, "secret"};
const AccessPolicy kAnywhere{false, "secret"};

TEST(Access, LoopbackIsAuthorizedOnlyUnderLoopbackNames) {
  for (const char* host : {"localhost:8080", "127.0.0.1:8080", "[::1]:8080", "localhost", "127.0.0.2:9"}) {
    EXPECT_TRUE(may_view({host, std::nullopt, ""}, kHere)) << host;
  }
  // A name made to point here (DNS rebinding), and invalid names.
  for (const char* host : {"evil.example:8080", "localhost.evil.example:8080", "127.0.0.1.evil.example",
                           "128.0.0.1", "", ":", "]:"}) {
    EXPECT_FALSE(may_view({host, std::nullopt, ""}, kHere)) << host;
  }
}

TEST(Access, ForeignOriginsAreRejected) {
  EXPECT_TRUE(may_view({"localhost:8080", "http://localhost:8080", ""}, kHere));
  for (const char* origin : {"http://evil.example", "http://localhost:9090", "https://localhost:8080", "null",
                             "", "http://localhost:8080.evil.example", "http://localhost"}) {
    EXPECT_FALSE(may_view({"localhost:8080", origin, ""}, kHere)) << origin;
    EXPECT_FALSE(may_view({"robot:8080", origin, "secret"}, kAnywhere)) << origin;
  }
}

TEST(Access, RemoteAccessRequiresTheToken) {
  EXPECT_TRUE(may_view({"robot:8080", std::nullopt, "secret"}, kAnywhere));
  EXPECT_TRUE(may_view({"robot:8080", "http://robot:8080", "secret"}, kAnywhere));
  for (const char* token : {"", "Secret", "secre", "secrets", "xxxxxx"}) {
    EXPECT_FALSE(may_view({"robot:8080", std::nullopt, token}, kAnywhere)) << token;
  }
}

TEST(Access, ControlRequiresTheTokenOnEveryAddress) {
  EXPECT_TRUE(may_control({"localhost:8080", std::nullopt, "secret"}, kHere));
  EXPECT_TRUE(may_control({"robot:8080", std::nullopt, "secret"}, kAnywhere));
  for (const char* token : {"", "Secret", "secre", "secrets"}) {
    EXPECT_FALSE(may_control({"localhost:8080", std::nullopt, token}, kHere)) << token;
    EXPECT_FALSE(may_control({"robot:8080", std::nullopt, token}, kAnywhere)) << token;
  }
  EXPECT_FALSE(may_control({"localhost:8080", "http://evil.example", "secret"}, kHere));
}

TEST(Access, TokensDiffer) {
  EXPECT_EQ(random_token().size(), 32U);
  EXPECT_NE(random_token(), random_token());
}

TEST(RequestTarget, IsAPathAndItsQuery) {
  const RequestTarget target = parse_target("/feed?since=17&run=ab&flag&=x&token=");
  EXPECT_EQ(target.path, "/feed");
  EXPECT_EQ(target.value("since"), "17");
  EXPECT_EQ(target.value("run"), "ab");
  EXPECT_EQ(target.value("token"), "");
  EXPECT_EQ(target.value("flag"), "");
  EXPECT_EQ(parse_target("/").path, "/");
  EXPECT_EQ(parse_target("?a=b").value("a"), "b");
  EXPECT_EQ(parse_target("").path, "");
}

TEST(ListenAddress, OmittedPartsHaveDefaults) {
  EXPECT_EQ(parse_listen_address("").port, 8080);
  EXPECT_EQ(parse_listen_address("0").port, 0);
  EXPECT_EQ(parse_listen_address("9000").address, "127.0.0.1");
  EXPECT_EQ(parse_listen_address("0.0.0.0:9000").address, "0.0.0.0");
  EXPECT_EQ(parse_listen_address("[::1]:9000").address, "::1");
  EXPECT_TRUE(is_loopback_address(parse_listen_address("[::1]:9000")));
  EXPECT_TRUE(is_loopback_address(parse_listen_address("")));
  EXPECT_FALSE(is_loopback_address(parse_listen_address("0.0.0.0:1")));
}

TEST(ListenAddress, InvalidAddressGivesTheExpectedSyntax) {
  for (const char* text :
       {"port", "65536", "-1", "80x", "host:80", "1.2.3:80", ":80", "127.0.0.1:", "8080:127.0.0.1"}) {
    EXPECT_THROW(parse_listen_address(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace kinloop
