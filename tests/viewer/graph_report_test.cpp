#include "viewer/report/graph_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinloop {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A square whose last corner is initially off, with one loop edge.
GraphReport square() {
  GraphReport report;
  report.title = "a <b> graph";
  report.subtitle = "4 vertices";
  report.tiles = {{"1 \u2192 0", "chi2"}};
  report.before = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.3, 1.2, 0}};
  report.after = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  report.steps = {{0, 1}, {1, 2}, {2, 3}};
  report.loops = {{3, 0}};
  return report;
}

size_t count(const std::string& text, const std::string& word) {
  size_t found = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

TEST(GraphReport, DrawsEveryEdgeBeforeAndAfter) {
  const std::string page = render_graph_report(square());
  EXPECT_EQ(count(page, "<svg"), 2U);
  EXPECT_EQ(count(page, "<path class=\"estimate\" d=\"M"), 2 * 3U + 2U) << "edges, and the legend's samples";
  EXPECT_EQ(count(page, "<path class=\"loop\" d=\"M"), 2 * 1U + 2U);
}

TEST(GraphReport, IsOneWholePageWithItsTextEscaped) {
  const std::string page = render_graph_report(square());
  EXPECT_THAT(page, HasSubstr("a &lt;b&gt; graph"));
  EXPECT_THAT(page, HasSubstr("4 vertices"));
  EXPECT_THAT(page, HasSubstr("chi2"));
  EXPECT_THAT(page, Not(HasSubstr("{{")));
  EXPECT_THAT(page, Not(HasSubstr("http://")));
}

TEST(GraphReport, ViewsAGraphAlongItsLeastExtent) {
  GraphReport upright = square();
  for (auto* points : {&upright.before, &upright.after}) {
    for (auto& p : *points) p = {0.5, 2 * p.x(), p.y()};
  }
  EXPECT_EQ(count(render_graph_report(upright), "nan"), 0U);
  EXPECT_NE(render_graph_report(upright), render_graph_report(square()));
}

TEST(GraphReport, SurvivesAGraphWithoutEdgesOrVertices) {
  GraphReport empty = square();
  empty.steps.clear();
  empty.loops.clear();
  EXPECT_THAT(render_graph_report(empty), HasSubstr("<svg"));
  empty.before.clear();
  empty.after.clear();
  EXPECT_THAT(render_graph_report(empty), HasSubstr("<svg"));
}

TEST(GraphReport, LimitsThePageSizeOfLargeGraphs) {
  GraphReport large = square();
  large.loops.assign(1000000, {3, 0});
  EXPECT_LT(render_graph_report(large).size(), 3000000U);
}

}  // namespace
}  // namespace kinloop
