#include <cmath>
#include <map>

#include <fmt/format.h>

#include "apps/reproduce/board_stills.hpp"
#include "apps/reproduce/chapters.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {
namespace {

constexpr int kDrawnStills = 25;

/// A table of the parameters of a camera, with the truth where it is known.
MarkdownTable parameter_table(const std::string& camera, const nlohmann::json& parameters,
                              const std::map<std::string, double>& truth) {
  MarkdownTable table{{camera, "estimate", "standard deviation"}};
  if (!truth.empty()) table[0].emplace_back("truth");
  for (const char* name : {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"}) {
    if (!parameters.contains(name)) continue;
    const auto& parameter = parameters[name];
    const int digits = name[0] == 'f' || name[0] == 'c' ? 2 : 5;
    const auto text = [&](double value) { return fmt::format("{:.{}f}", value, digits); };
    table.push_back({name, text(parameter["value"]), text(parameter["deviation"])});
    if (truth.contains(name)) table.back().push_back(text(truth.at(name)));
  }
  return table;
}

nlohmann::json calibrate(Chapter& chapter, const ReproduceFolder& folder, const std::string& what,
                         const std::vector<std::string>& words, const std::string& name) {
  std::vector<std::string> line{"calibrate", what};
  line.insert(line.end(), words.begin(), words.end());
  line.insert(line.end(), {"--board", folder.arguments.board, "--square",
                           fmt::format("{}", folder.arguments.square_m), "-o", folder.at(name + ".yaml")});
  run_program(chapter, line);
  chapter.links.emplace_back("Report of " + name, name + ".html");
  return nlohmann::json::parse(read_file(folder.at(name + ".json")));
}

void calibrate_drawn_stills(Chapter& chapter, const ReproduceFolder& folder) {
  chapter.text = fmt::format(
      "The paper calibrates a Kinect 2 with chessboards. Here {} stills of a board are drawn as a known "
      "camera "
      "sees them; pass real ones with --stills.",
      kDrawnStills);
  const std::string stills = folder.at("stills");
  draw_board_stills(stills, kDrawnStills);
  const PinholeCamera truth = simulated_board_camera();
  chapter.figures["drawn"] = calibrate(chapter, folder, "intrinsics", {stills}, "drawn_camera");
  chapter.tables.push_back(parameter_table("drawn camera", chapter.figures["drawn"]["parameters"],
                                           {{"fx", truth.fx},
                                            {"fy", truth.fy},
                                            {"cx", truth.cx},
                                            {"cy", truth.cy},
                                            {"k1", truth.lens.k1},
                                            {"k2", truth.lens.k2},
                                            {"p1", truth.lens.p1},
                                            {"p2", truth.lens.p2},
                                            {"k3", truth.lens.k3}}));
  chapter.pictures.emplace_back("A drawn still", "stills/00.png");
}

/// The transform between the cameras, from the pairs.
void calibrate_pairs(Chapter& chapter, const ReproduceFolder& folder, const std::filesystem::path& stills) {
  const auto rig = calibrate(chapter, folder, "extrinsics",
                             {(stills / "sync").string(), "--color", (stills / "colour").string(),
                              "--infrared", (stills / "ir").string()},
                             "camera");
  chapter.figures["rig"] = rig;
  MarkdownTable table{{"infrared in colour, mm", "estimate", "standard deviation"}};
  const auto& transform = rig["T_color_infrared"];
  for (size_t i = 0; i < 3; ++i) {
    table.push_back({std::string(1, "xyz"[i]),
                     fmt::format("{:.2f}", 1000 * transform["translation"][i].get<double>()),
                     fmt::format("{:.2f}", 1000 * transform["deviations"][i].get<double>())});
  }
  chapter.tables.push_back(table);
}

}  // namespace

Chapter calibration_chapter(const ReproduceFolder& folder) {
  Chapter chapter;
  chapter.title = "Calibration";
  const std::filesystem::path stills = folder.arguments.stills;
  if (stills.empty()) {
    calibrate_drawn_stills(chapter, folder);
    return chapter;
  }
  chapter.text =
      "The paper calibrates a Kinect 2 with chessboards: each camera alone, then the transform between them.";
  const bool folders = std::filesystem::is_directory(stills / "colour");
  const std::string color = (folders ? stills / "colour" : stills).string();
  chapter.figures["colour"] = calibrate(chapter, folder, "intrinsics", {color}, "colour");
  chapter.tables.push_back(parameter_table("colour", chapter.figures["colour"]["parameters"], {}));
  if (folders && std::filesystem::is_directory(stills / "ir")) {
    chapter.figures["infrared"] =
        calibrate(chapter, folder, "intrinsics", {(stills / "ir").string()}, "infrared");
    chapter.tables.push_back(parameter_table("infrared", chapter.figures["infrared"]["parameters"], {}));
    if (std::filesystem::is_directory(stills / "sync")) calibrate_pairs(chapter, folder, stills);
  }
  return chapter;
}

}  // namespace kinloop
