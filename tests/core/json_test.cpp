#include "kinloop/core/text/json.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>

#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

TEST(JsonText, BytesThatAreNotUtf8AreReplaced) {
  const std::string text = json_text({{"input", "data/caf\xe9/\xff"}});
  EXPECT_EQ(text, "{\"input\":\"data/caf\xef\xbf\xbd/\xef\xbf\xbd\"}");
  EXPECT_EQ(parse_json(text)["input"], "data/caf\xef\xbf\xbd/\xef\xbf\xbd");
  EXPECT_EQ(json_text("\xe9", -1, JsonCharacters::kAscii), "\"\\ufffd\"");
}

TEST(JsonText, GoodTextStays) {
  EXPECT_EQ(json_text({{"caf\u00e9", 1}}, 1), "{\n \"caf\u00e9\": 1\n}");
}

/// `depth` brackets open at once.
std::string nested(size_t depth) {
  return std::string(depth, '[') + std::string(depth, ']');
}

TEST(ParseJson, RefusesWhatIsNestedTooDeeply) {
  EXPECT_FALSE(parse_json(nested(kMaxJsonDepth)).is_discarded());
  EXPECT_TRUE(parse_json(nested(kMaxJsonDepth + 1)).is_discarded());
  EXPECT_TRUE(parse_json(nested(100'000)).is_discarded());
  EXPECT_TRUE(parse_json(std::string(100'000, '{')).is_discarded());
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
  EXPECT_TRUE(parse_json(objects).is_discarded());
}

TEST(ParseJson, BracketsSideBySideOrInStringsDoNotNest) {
  std::string many = "[[]";
  for (int i = 0; i < 1000; ++i) many += ",[{}]";
  EXPECT_EQ(parse_json(many + "]").size(), 1001U);
  const std::string brackets(1000, '[');
  EXPECT_EQ(parse_json("[\"\\\"" + brackets + "\"]").at(0), "\"" + brackets);
  EXPECT_TRUE(parse_json("]]}").is_discarded());
}

/// The sources of the program and the library that call a function of nlohmann's which this module replaces.
std::vector<std::string> sources_with(const std::string& call) {
  std::vector<std::string> found;
  for (const char* folder :
       {"apps", "drivers", "kinloop", "python", "session", "simulator", "tools", "viewer"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(test::source_folder() / folder)) {
      const auto extension = entry.path().extension();
      if (extension != ".cpp" && extension != ".hpp") continue;
      std::ifstream stream(entry.path());
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      if (text.find(call) != std::string::npos) found.push_back(entry.path().filename().string());
    }
  }
  return found;
}

TEST(JsonText, NothingElseWritesJson) {
  EXPECT_THAT(sources_with(".dump("), testing::ElementsAre("json.cpp"));
}

}  // namespace
}  // namespace kinloop
