// Replays the corpus of every fuzz target, among it each input that once found a defect.

#include <algorithm>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/random.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

class FuzzCorpusTest : public testing::TestWithParam<fuzz::FuzzTarget> {
 protected:
  FuzzCorpusTest() { log::set_level(spdlog::level::off); }
  ~FuzzCorpusTest() override { log::set_level(spdlog::level::info); }

  static std::vector<std::filesystem::path> corpus() {
    std::vector<std::filesystem::path> files;
    const auto folder = test::source_folder() / "tests/fuzz/corpus" / GetParam().name;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
  }
};

TEST_P(FuzzCorpusTest, EveryInputIsReadOrRejected) {
  const auto files = corpus();
  ASSERT_FALSE(files.empty());
  for (const auto& file : files) EXPECT_NO_THROW(GetParam().run(read_file(file))) << file;
}

TEST_P(FuzzCorpusTest, EveryInputMayBeCutShort) {
  constexpr size_t kCuts = 5;
  for (const auto& file : corpus()) {
    const std::string bytes = read_file(file);
    for (size_t i = 0; i < kCuts; ++i)
      EXPECT_NO_THROW(GetParam().run(std::string_view(bytes).substr(0, bytes.size() * i / kCuts)))
          << file << i;
  }
}

/// Without the feedback of libFuzzer; with sanitizers where the test runs with them.
TEST_P(FuzzCorpusTest, EveryInputMayBeChanged) {
  Random random(7);
  for (const auto& file : corpus()) {
    const std::string bytes = read_file(file);
    for (int i = test::mutations(100); i > 0; --i) {
      const std::string input = test::mutated(bytes, random);
      EXPECT_NO_THROW(GetParam().run(input)) << file << ", mutation " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, FuzzCorpusTest, testing::ValuesIn(fuzz::fuzz_targets()),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace kinloop
