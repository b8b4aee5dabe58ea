// kinloop share, end to end; what is in the page is tested in tests/viewer and tests/browser.

#include <gmock/gmock.h>

#include "dense/files/ply.hpp"
#include "tests/apps/program_test.hpp"

namespace kinloop::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kCloud =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
    "z\nend_header\n"
    "1 2 3\n2 2 3\n";

class ShareCommandTest : public ProgramTest {
 protected:
  [[nodiscard]] Run share(const std::string& name, const std::string& options = "") const {
    return run("share '" + at(name) + "' -o '" + at("page.html") + "' " + options);
  }
  [[nodiscard]] bool has_page() const { return std::filesystem::exists(at("page.html")); }
};

TEST_F(ShareCommandTest, WritesOnePageAndSaysWhatIsInIt) {
  folder_.write("cloud.ply", kCloud);
  const Run done = share("cloud.ply");
  ASSERT_EQ(done.exit_code, kDone) << done.err;
  EXPECT_THAT(done.out, AllOf(HasSubstr("page.html: "), HasSubstr(" MB, 2 of 2 points, 0 images")));
  EXPECT_THAT(read_file(at("page.html")), HasSubstr("</html>"));
  EXPECT_THAT(share("cloud.ply", "--points 1").out, HasSubstr("1 of 2 points"));
  EXPECT_EQ(share("cloud.ply", "-q").out, "");
}

TEST_F(ShareCommandTest, SharesTheFolderOfARunWithItsMeshOnRequest) {
  folder_.write("out/trajectory.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n");
  write_ply(at("out/map.ply"), {{{1, 2, 3}, {2, 2, 3}}, {{255, 0, 0}, {0, 0, 255}}});
  EXPECT_THAT(share("out").out, HasSubstr("2 of 2 points"));
  const Run without = share("out", "--mesh");
  EXPECT_EQ(without.exit_code, kBadInput);
  EXPECT_THAT(without.err, AllOf(HasSubstr("has no mesh"), HasSubstr("kinloop mesh " + at("out"))));
  folder_.write(
      "out/mesh.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 1\n1 0 1\n1 1 1\n3 0 1 2\n");
  EXPECT_THAT(share("out", "--mesh").out, HasSubstr(" MB, 1 triangles, 0 images")) << "in place of the cloud";
  EXPECT_THAT(share("out", "--mesh --points 1").out, HasSubstr("1 of 2 points, 1 triangles, "));
}

TEST_F(ShareCommandTest, NamesNoCommandForAFileWithoutAMesh) {
  folder_.write("cloud.ply", kCloud);
  const Run done = share("cloud.ply", "--mesh");
  EXPECT_EQ(done.exit_code, kBadInput);
  EXPECT_THAT(done.err, AllOf(HasSubstr("has no mesh; share the folder"), Not(HasSubstr("kinloop mesh"))));
}

TEST_F(ShareCommandTest, DamagedInputIsOneLineAndLeavesAnEarlierPage) {
  folder_.write("bad.ply", "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nend_header\n1\n");
  folder_.write("bad.kinmap", "nothing of the kind");
  folder_.write("notes.txt", "text");
  for (const char* name : {"bad.ply", "bad.kinmap", "notes.txt", "missing"}) {
    const Run done = share(name);
    EXPECT_EQ(done.exit_code, kBadInput) << name;
    EXPECT_THAT(done.err, HasSubstr(name));
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
    EXPECT_FALSE(has_page()) << name;
  }
  folder_.write("page.html", "earlier");
  EXPECT_EQ(share("bad.ply").exit_code, kBadInput);
  EXPECT_EQ(read_file(at("page.html")), "earlier");
}

TEST_F(ShareCommandTest, OptionsOutOfRangeAreUsageErrors) {
  folder_.write("cloud.ply", kCloud);
  for (const char* options :
       {"--max-size 0", "--max-size nan", "--max-size 101", "--points -1", "--points many"}) {
    EXPECT_EQ(share("cloud.ply", options).exit_code, kWrongUse) << options;
    EXPECT_FALSE(has_page()) << options;
  }
  const Run over = run("share '" + at("cloud.ply") + "' -o '" + at("cloud.ply") + "'");
  EXPECT_EQ(over.exit_code, kWrongUse);
  EXPECT_EQ(read_file(at("cloud.ply")), kCloud) << "the input is not replaced";
}

}  // namespace
}  // namespace kinloop::test
