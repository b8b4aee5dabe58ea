#include "tools/export/g2o/g2o_file.hpp"

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/core/files/text_file.hpp"
#include "tests/optimize/pose_graph_world.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::input_error;
using test::TempFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kIdentity6 = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1";
constexpr const char* kIdentity3 = " 1 0 0 1 0 1";

G2oFile read_text(const std::string& text) {
  const TempFolder folder;
  return read_g2o(folder.write("graph.g2o", text));
}

std::string error_of(const std::string& text) {
  return input_error([&] { read_text(text); });
}

std::string plane(int id) {
  return "VERTEX_SE2 " + std::to_string(id) + " 0 0 0\n";
}

TEST(G2oFile, ReadsSe3Poses) {
  const G2oFile file = read_text(std::string("# a comment\n\n"
                                             "VERTEX_SE3:QUAT 7 1 2 3 0 0 0.6 0.8\r\n"
                                             "VERTEX_SE3:QUAT 3 0 0 0 0 0 0 2\n"
                                             "FIX 3\n"
                                             "EDGE_SE3:QUAT 7 3 4 5 6 0 0 0 1") +
                                 " 1 2 3 4 5 6 70 8 9 10 11 120 13 14 15 160 17 18 190 20 210");
  const auto& graph = std::get<PoseGraph>(file.graph);
  EXPECT_THAT(file.ids, ElementsAre(7, 3));
  EXPECT_THAT(graph.fixed, ElementsAre(false, true));
  EXPECT_EQ(graph.T_world_vertex[0].translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(graph.T_world_vertex[0].rotation.z(), 0.6, 1e-15);
  EXPECT_EQ(graph.T_world_vertex[1].rotation.w(), 1) << "quaternions are normalised";
  ASSERT_EQ(graph.edges.size(), 1U);
  EXPECT_EQ(graph.edges[0].a, 0U);
  EXPECT_EQ(graph.edges[0].b, 1U);
  EXPECT_FALSE(graph.edges[0].is_odometry);
  EXPECT_EQ(graph.edges[0].T_a_b.translation, Eigen::Vector3d(4, 5, 6));
  EXPECT_TRUE(file.had_vertices);
}

TEST(G2oFile, ReadsInformationRowByRow) {
  const G2oFile file = read_text(plane(0) + plane(1) + "EDGE_SE2 0 1 1 2 0.5 10 2 3 20 4 30\n");
  const auto& edge = std::get<PoseGraph2d>(file.graph).edges.at(0);
  Eigen::Matrix3d expected;
  expected << 10, 2, 3, 2, 20, 4, 3, 4, 30;
  EXPECT_EQ(edge.information, expected);
  EXPECT_TRUE(edge.is_odometry) << "successive ids are odometry";
  EXPECT_EQ(edge.T_a_b.angle_rad, 0.5);
}

template <class Pose>
void expect_round_trip() {
  const TempFolder folder;
  auto world = test::make_loop_world<Pose>({}, 1);
  world.graph.fixed.assign(world.truth.size(), false);
  world.graph.fixed[2] = world.graph.fixed[5] = true;
  world.graph.edges.push_back({kWorld, 4, world.truth[4], world.graph.edges[0].information, false});
  G2oFile file{world.graph, {}, true, {}};
  for (size_t i = 0; i < world.truth.size(); ++i) file.ids.push_back(static_cast<int64_t>(1000 - 7 * i));
  const auto path = folder.path() / "out.g2o";
  write_g2o(path, file);
  const G2oFile again = read_g2o(path);
  const auto& graph = std::get<BasicPoseGraph<Pose>>(again.graph);
  EXPECT_EQ(again.ids, file.ids);
  EXPECT_EQ(graph.fixed, world.graph.fixed);
  EXPECT_TRUE(again.repaired_lines.empty());
  EXPECT_NEAR(chi2(graph), chi2(world.graph), 1e-12 * chi2(graph));
  ASSERT_EQ(graph.edges.size(), world.graph.edges.size());
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    EXPECT_EQ(graph.edges[i].a, world.graph.edges[i].a);
    EXPECT_EQ(graph.edges[i].b, world.graph.edges[i].b);
    EXPECT_EQ(graph.edges[i].information, world.graph.edges[i].information);
    EXPECT_EQ(graph.edges[i].T_a_b.translation, world.graph.edges[i].T_a_b.translation);
  }
}

TEST(G2oFile, RoundTrips) {
  expect_round_trip<SE3>();
  expect_round_trip<SE2>();
}

TEST(G2oFile, NumbersVerticesWithoutIds) {
  const TempFolder folder;
  write_g2o(folder.path() / "out.g2o", {test::make_loop_world<SE2>({}, 2).graph, {}, true, {}});
  EXPECT_EQ(read_g2o(folder.path() / "out.g2o").ids.at(9), 9);
}

TEST(G2oFile, ChainsPosesOfFilesWithoutVertices) {
  const G2oFile file =
      read_text(std::string("EDGE_SE2 12 10 1 0 0.5") + kIdentity3 + "\nEDGE_SE2 10 11 2 0 0" + kIdentity3);
  const auto& graph = std::get<PoseGraph2d>(file.graph);
  EXPECT_FALSE(file.had_vertices);
  EXPECT_THAT(file.ids, ElementsAre(10, 11, 12));
  EXPECT_LT(chi2(graph), 1e-25);
}

TEST(G2oFile, ReplacesIndefiniteInformationByTheNearest) {
  const G2oFile file =
      read_text(plane(0) + plane(1) + "EDGE_SE2 0 1 1 0 0 1 2 0 1 0 5\n" + "EDGE_SE2 0 1 1 0 0" + kIdentity3);
  EXPECT_THAT(file.repaired_lines, ElementsAre(3));
  const auto& information = std::get<PoseGraph2d>(file.graph).edges[0].information;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
  EXPECT_NEAR(eigen.eigenvalues()[0], 0, 1e-14);  // was -1
  EXPECT_NEAR(eigen.eigenvalues()[1], 3, 1e-14);
  EXPECT_NEAR(eigen.eigenvalues()[2], 5, 1e-14);
}

TEST(G2oFile, KeepsSingularInformation) {
  const G2oFile file = read_text(plane(0) + plane(1) + "EDGE_SE2 0 1 1 0 0 1 1 0 1 0 0\n");
  EXPECT_TRUE(file.repaired_lines.empty());
}

TEST(G2oFile, ReadsPriors) {
  const G2oFile space =
      read_text(std::string("VERTEX_SE3:QUAT 4 0 0 0 0 0 0 1\nPARAMS_SE3OFFSET 9 0 0 0 0 0 0 1\n"
                            "EDGE_SE3_PRIOR 4 9 1 2 3 0 0 0 1") +
                kIdentity6);
  EXPECT_EQ(std::get<PoseGraph>(space.graph).edges.at(0).a, kWorld);
  EXPECT_NEAR(chi2(std::get<PoseGraph>(space.graph)), 14, 1e-14);
  const G2oFile flat = read_text(plane(4) + "EDGE_PRIOR_SE2 4 1 2 0" + kIdentity3);
  EXPECT_NEAR(chi2(std::get<PoseGraph2d>(flat.graph)), 5, 1e-14);
}

TEST(G2oFile, ErrorsNameFileAndLine) {
  const std::string edge = std::string("EDGE_SE2 0 1 1 0 0") + kIdentity3 + "\n";
  const struct {
    const char* what;
    std::string text;
    const char* line;
    const char* word;
  } cases[] = {
      {"duplicate vertex", plane(0) + plane(1) + plane(0) + edge, ":3:", "line 1"},
      {"unknown vertex", plane(0) + plane(2) + edge, ":3:", "undefined vertex 1"},
      {"unknown fixed vertex", plane(0) + plane(1) + "FIX 5\n" + edge, ":3:", "undefined vertex 5"},
      {"unknown prior vertex", plane(0) + "EDGE_PRIOR_SE2 4 1 2 0" + kIdentity3, ":2:", "undefined vertex 4"},
      {"not a number", plane(0) + "VERTEX_SE2 1 nan 0 0\n" + edge, ":2:", "nan"},
      {"not a number", plane(0) + "VERTEX_SE2 1 0 0 x1\n" + edge, ":2:", "x1"},
      {"infinite", plane(0) + plane(1) + "EDGE_SE2 0 1 1 0 0 inf 0 0 1 0 1", ":3:", "inf"},
      {"no id", plane(0) + "VERTEX_SE2 1.5 0 0 0\n" + edge, ":2:", "1.5"},
      {"truncated", plane(0) + plane(1) + "EDGE_SE2 0 1 1 0 0 1 0", ":3:", "truncated"},
      {"too long", plane(0) + "VERTEX_SE2 1 0 0 0 0\n", ":2:", "expected 5"},
      {"unknown tag", plane(0) + "VERTEX_XY 1 0 0\n", ":2:", "VERTEX_XY"},
      {"an edge to itself", plane(0) + "EDGE_SE2 0 0 1 0 0" + kIdentity3, ":2:", "itself"},
      {"space and plane", plane(0) + "VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n", ":2:", "same file"},
      {"no rotation", "VERTEX_SE3:QUAT 1 0 0 0 0 0 0 0\n", ":1:", "quaternion"},
      {"prior without offset",
       std::string("VERTEX_SE3:QUAT 4 0 0 0 0 0 0 1\nEDGE_SE3_PRIOR 4 0 0 0 0 0 0 0 1") + kIdentity6,
       ":2:", "PARAMS_SE3OFFSET 0"},
      {"offset", "PARAMS_SE3OFFSET 0 1 0 0 0 0 0 1\n", ":1:", "identity"},
      {"overflow", plane(0) + plane(1) + edge + "EDGE_SE2 0 1 1e200 0 0" + kIdentity3, ":4:", "too large"},
      {"overflow from the start", plane(0) + "VERTEX_SE2 1 1e300 0 0\n" + edge, ":3:", "too large"},
      {"binary", plane(0) + std::string("VERTEX_SE2 \0 0", 14), ":2:", "not a text file"},
  };
  for (const auto& bad : cases) {
    EXPECT_THAT(error_of(bad.text), AllOf(HasSubstr("graph.g2o"), HasSubstr(bad.line), HasSubstr(bad.word)))
        << bad.what;
  }
}

TEST(G2oFile, RejectsFilesWithoutAGraph) {
  EXPECT_THAT(error_of(""), HasSubstr("graph.g2o"));
  EXPECT_THAT(error_of("# nothing\n"), HasSubstr("no vertices"));
  EXPECT_THAT(input_error([] { read_g2o("/nonexistent/graph.g2o"); }), HasSubstr("/nonexistent/graph.g2o"));
}

TEST(G2oFile, KeepsTheOldFileIfWritingFails) {
  EXPECT_THAT(input_error([] {
                write_g2o("/nonexistent/out.g2o", {PoseGraph{}, {}, true, {}});
              }),
              HasSubstr("/nonexistent/out.g2o"));
}

}  // namespace
}  // namespace kinloop
