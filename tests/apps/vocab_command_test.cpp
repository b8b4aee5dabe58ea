// kinloop vocab, end to end, as one process and as one of several.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;

using test::kBadInput;
using test::kWrongUse;

/// A file of ORB descriptors (docs/method.md) of `images` images with `per_image` random descriptors each.
std::string descriptor_file(uint32_t images, uint32_t per_image) {
  const auto number = [](uint64_t value, size_t bytes) {
    std::string text;
    for (size_t i = 0; i < bytes; ++i) text.push_back(static_cast<char>(value >> (8 * i)));
    return text;
  };
  std::string file =
      "KINDESC\n" + number(1, 4) + number(1, 4) + number(images, 8) + number(uint64_t{images} * per_image, 8);
  Random random(1);
  for (uint32_t i = 0; i < images * per_image * 4; ++i) file += number(random.next(), 8);
  for (uint32_t i = 0; i < images; ++i) file += number(per_image, 4);
  return file;
}

class VocabCommand : public test::ProgramTest {
 protected:
  VocabCommand() { folder_.write("some.kindesc", descriptor_file(25, 1000)); }

  /// `arguments` follow "kinloop vocab".
  [[nodiscard]] Run run(const std::string& arguments) const { return ProgramTest::run("vocab " + arguments); }

  [[nodiscard]] std::string train_arguments(const std::string& output) const {
    return "train '" + at("some.kindesc") + "' -k 5 -L 3 --iterations 3 --threads 1 -o '" + at(output) + "'";
  }

  /// `before` is what rank 1 runs before it trains; `flags` are additional flags for it.
  [[nodiscard]] Run run_many(int ranks, const std::string& output, const std::string& before,
                             const std::string& flags) const {
    const auto script = folder_.write(
        "rank.sh", "if [ $OMPI_COMM_WORLD_RANK = 1 ]; then " + before + " more='" + flags +
                       "'; fi\nexec '" KINLOOP_PROGRAM "' vocab " + train_arguments(output) + " $more\n");
    return shell(
        "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 "
        "timeout 120 mpirun -n " +
        std::to_string(ranks) + " sh '" + script.string() + "'");
  }

  [[nodiscard]] bool has_mpi() const {
    return shell("'" KINLOOP_PROGRAM "' --version").out.find("distributed training: yes") !=
               std::string::npos &&
           shell("mpirun --version").exit_code == 0;
  }
};

TEST_F(VocabCommand, TrainsAndPrintsStatistics) {
  const Run trained = run(train_arguments("a.kinvoc") + " --init 'kmeans||'");
  ASSERT_EQ(trained.exit_code, 0) << trained.err;
  EXPECT_THAT(trained.out, AllOf(HasSubstr("words          125"), HasSubstr("25000 descriptors of 25 images"),
                                 HasSubstr("skipped        0 unreadable")));
  const Run info = run("info '" + at("a.kinvoc") + "'");
  EXPECT_THAT(info.out, AllOf(HasSubstr("ORB, 256 bits"), HasSubstr("at most 5 children, 3 levels"),
                              HasSubstr("balance"), HasSubstr("idf"), HasSubstr("opened in")));
}

TEST_F(VocabCommand, ExportsAndImports) {
  ASSERT_EQ(run(train_arguments("a.kinvoc")).exit_code, 0);
  ASSERT_EQ(run("export '" + at("a.kinvoc") + "' -o '" + at("a.txt") + "'").exit_code, 0);
  const Run imported = run("import '" + at("a.txt") + "' -o '" + at("b.kinvoc") + "'");
  EXPECT_EQ(imported.exit_code, 0) << imported.err;
  EXPECT_THAT(imported.out, AllOf(HasSubstr("words          125"), HasSubstr("imported vocabulary")));
}

TEST_F(VocabCommand, UnusableInputGivesAnErrorWithRemedy) {
  Run failed = run("train '" + at("some.kindesc") + "' -k 10 -L 6 -o '" + at("a.kinvoc") + "'");
  EXPECT_EQ(failed.exit_code, kBadInput);
  EXPECT_THAT(failed.err, HasSubstr("25000 descriptors are too few for a vocabulary of up to 10^6 words"));
  failed = run(train_arguments("a.kinvoc") + " --euclidean");
  EXPECT_EQ(failed.exit_code, kWrongUse);
  EXPECT_THAT(failed.err, HasSubstr("ORB's descriptors are binary"));
  failed = run(train_arguments("a.kinvoc") + " --feature sift");
  EXPECT_EQ(failed.exit_code, kBadInput);
  EXPECT_THAT(failed.err, AllOf(HasSubstr("some.kindesc"), HasSubstr("expected SIFT")));
  EXPECT_EQ(run("info '" + at("some.kindesc") + "'").exit_code, kBadInput);
  EXPECT_FALSE(std::filesystem::exists(at("a.kinvoc")));
}

TEST_F(VocabCommand, RunsRejectAVocabularyOfAnotherKind) {
  ASSERT_EQ(run(train_arguments("a.kinvoc")).exit_code, 0);
  const Run failed = shell("'" KINLOOP_PROGRAM "' run sim:room -o '" + at("run") +
                           "' --set features.kind=sift --vocabulary '" + at("a.kinvoc") + "'");
  EXPECT_EQ(failed.exit_code, kWrongUse);
  EXPECT_THAT(failed.err, AllOf(HasSubstr("a.kinvoc: a vocabulary of ORB"), HasSubstr("--feature sift")));
}

TEST_F(VocabCommand, SeveralProcessesGiveIdenticalBytes) {
  if (!has_mpi()) GTEST_SKIP() << "no mpirun, or built without MPI";
  ASSERT_EQ(run(train_arguments("one.kinvoc")).exit_code, 0);
  const Run many = run_many(2, "many.kinvoc", "", "");
  ASSERT_EQ(many.exit_code, 0) << many.err;
  EXPECT_EQ(read_file(at("many.kinvoc")), read_file(at("one.kinvoc")));
}

TEST_F(VocabCommand, AProcessThatDiesEndsAll) {
  if (!has_mpi()) GTEST_SKIP() << "no mpirun, or built without MPI";
  constexpr int kTimedOut = 124;
  const Run killed = run_many(2, "many.kinvoc", "(sleep 0.2; kill -9 $$) &", "");
  EXPECT_THAT(killed.exit_code, AllOf(testing::Ne(0), testing::Ne(kTimedOut)));
  EXPECT_THAT(killed.err, AllOf(HasSubstr("rank 1"), HasSubstr("Killed")));
  const Run failed = run_many(2, "many.kinvoc", "", "--memory 0 --scratch /nowhere");
  EXPECT_THAT(failed.exit_code, AllOf(testing::Ne(0), testing::Ne(kTimedOut)));
  EXPECT_THAT(failed.err, AllOf(HasSubstr("/nowhere"), HasSubstr("job")));
  EXPECT_FALSE(std::filesystem::exists(at("many.kinvoc")));
}

}  // namespace
}  // namespace kinloop
