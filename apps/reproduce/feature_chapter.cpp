#include <array>

#include <fmt/format.h>

#include "apps/reproduce/chapters.hpp"

namespace kinloop {
namespace {

/// A row of Table 1 of the paper.
struct PaperRow {
  const char* detector;
  int features;
  double seconds;
};
constexpr std::array<PaperRow, 3> kPaperTable = {
    {{"sift", 983, 0.6441}, {"surf", 1455, 0.2251}, {"orb-opencv", 562, 0.0268}}};

std::vector<std::string> table_row(const nlohmann::json& detector) {
  const std::string id = detector["detector"];
  const auto number = [&](const char* key, int digits, double unit = 1) {
    return detector.contains(key) ? fmt::format("{:.{}f}", unit * detector[key].get<double>(), digits)
                                  : std::string();
  };
  std::vector<std::string> row{detector["name"], "", ""};
  for (const PaperRow& paper : kPaperTable) {
    if (id == paper.detector)
      row = {detector["name"], std::to_string(paper.features), fmt::format("{}", paper.seconds)};
  }
  row.insert(row.end(), {number("keypoints", 0), number("milliseconds", 4, 1e-3), number("matches", 0),
                         number("screened", 0), number("inliers", 0), number("repeatability", 1, 100),
                         number("precision", 1, 100)});
  return row;
}

}  // namespace

Chapter feature_chapter(const ReproduceFolder& folder) {
  Chapter chapter;
  chapter.title = "Features: Table 1, Figures 3 and 4";
  chapter.text =
      "The paper counts the features of one image and the seconds to detect and describe them, and screens "
      "matches "
      "at four times the smallest distance. Here each figure is a median over frame pairs, 10 frames apart.";
  const std::string json = run_program(
      chapter, {"features", folder.sequence, "--gap", "10", "-o", folder.at("matches"), "--json"});
  chapter.figures = nlohmann::json::parse(json);
  MarkdownTable table{{"", "paper: features", "paper: s", "features", "s", "matches", "screened", "inliers",
                       "repeatability, %", "precision, %"}};
  for (const auto& detector : chapter.figures) table.push_back(table_row(detector));
  chapter.tables.push_back(table);
  for (const char* detector : {"sift", "surf", "orb"}) {
    for (const char* kind : {"all", "screened", "inliers"}) {
      const std::string file = fmt::format("matches/{}_{}.png", detector, kind);
      if (!std::filesystem::exists(folder.arguments.output / file)) continue;
      chapter.pictures.emplace_back(fmt::format("Matches of {}: {}", detector, kind), file);
    }
  }
  return chapter;
}

}  // namespace kinloop
