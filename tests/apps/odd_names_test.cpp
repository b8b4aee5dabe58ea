// Paths may hold any bytes but '/' and 0: results and messages survive them.

#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using test::kBadInput;
using test::kDone;
using testing::HasSubstr;

class OddNames : public test::ProgramTest {};

TEST_F(OddNames, BytesThatAreNotUtf8) {
  const std::string sequence = at("caf\xe9\xff"), out = at("out\xfe");
  ASSERT_EQ(run("simulate room --frames 4 --size 160x120 -q -o '" + sequence + "'").exit_code, kDone);
  const Run done = run("run '" + sequence + "' -q -o '" + out + "'");
  EXPECT_EQ(done.exit_code, kDone) << done.err;
  for (const char* name : {"run.json", "report.html", "graph.g2o", "map.kinmap"})
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out) / name)) << name;
  EXPECT_THAT(nlohmann::json::parse(read_file(out + "/run.json"))["input"].get<std::string>(),
              HasSubstr("caf\xef\xbf\xbd"));
  EXPECT_EQ(run("map info --json '" + out + "'").exit_code, kDone);
  EXPECT_EQ(run("report '" + out + "'").exit_code, kDone);
}

TEST_F(OddNames, LineBreaksInAMessageAreEscaped) {
  const Run refused = run("eval x 'no\nsuch\033[31mfile'");
  EXPECT_EQ(refused.exit_code, kBadInput);
  EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("no\\nsuch\\x1b[31mfile: no such file"));
}

TEST_F(OddNames, ControlCharactersOfUnicodeInAMessageAreEscaped) {
  for (const std::string control : {"\u009b31m", "\u202e", "\u2066"}) {
    const Run refused = run("eval 'a" + control + "b' x");
    EXPECT_EQ(refused.exit_code, kBadInput);
    EXPECT_EQ(refused.err.find(control), std::string::npos);
  }
  EXPECT_THAT(run("eval x 'caf\u00e9'").err, HasSubstr("caf\u00e9"));
}

}  // namespace
}  // namespace kinloop
