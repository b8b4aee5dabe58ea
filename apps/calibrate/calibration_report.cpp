#include <cmath>

#include <fmt/format.h>

#include "apps/calibrate/calibrate_steps.hpp"
#include "kinloop/core/text/escaped.hpp"
#include "viewer/report/html_page.hpp"
#include "viewer/report/svg_plot.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

constexpr double kMm = 1000, kDegrees = 180 / 3.14159265358979323846;

/// Enough digits for pixels and for distortion.
std::string number(double value) {
  return fmt::format("{:.{}f}", value, std::abs(value) >= 10 ? 2 : 5);
}

json parameters_json(const PinholeCamera& camera, const LensCovariance& covariance) {
  json figures;
  const auto values = lens_parameters(camera);
  for (const int i : parameters_of(camera.lens.model)) {
    figures[kLensParameterNames[i]] = {{"value", values(i)}, {"deviation", std::sqrt(covariance(i, i))}};
  }
  return figures;
}

json rejected_json(const std::vector<RejectedView>& rejected) {
  json list = json::array();
  for (const auto& view : rejected) list.push_back({{"name", view.name}, {"reason", view.reason}});
  return list;
}

json numbers(const auto& vector) {
  return std::vector<double>(vector.begin(), vector.end());
}

std::string parameters_text(const PinholeCamera& camera, const LensCovariance& covariance) {
  std::string text;
  const auto values = lens_parameters(camera);
  for (const int i : parameters_of(camera.lens.model)) {
    text += fmt::format("  {:<3} {:>11} +- {}\n", kLensParameterNames[i], number(values(i)),
                        number(std::sqrt(covariance(i, i))));
  }
  return text;
}

std::string rejected_text(const std::vector<RejectedView>& rejected) {
  std::string text;
  for (const auto& view : rejected) text += fmt::format("  rejected: {}: {}\n", view.name, view.reason);
  return text;
}

std::string table(const std::string& head, const std::string& rows) {
  return fmt::format("<div class=\"table\"><table><tr>{}</tr>{}</table></div>\n", head, rows);
}

std::string figure(const std::string& svg, const std::string& caption) {
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", svg, caption);
}

std::string rejected_list(const std::vector<RejectedView>& rejected) {
  std::string rows;
  for (const auto& v : rejected) {
    rows += fmt::format("<tr><td>{}</td><td>{}</td></tr>", escaped_markup(v.name), escaped_markup(v.reason));
  }
  return rejected.empty() ? "" : "<h2>Rejected views</h2>\n" + table("<th>image</th><th>reason</th>", rows);
}

std::string parameter_table(const PinholeCamera& camera, const LensCovariance& covariance,
                            const PinholeCamera* closed_form) {
  std::string rows;
  const auto values = lens_parameters(camera);
  for (const int i : parameters_of(camera.lens.model)) {
    const std::string closed = closed_form != nullptr ? number(lens_parameters(*closed_form)(i)) : "";
    rows += fmt::format(
        "<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>"
        "<td class=\"number\">{}</td></tr>",
        kLensParameterNames[i], number(values(i)), number(std::sqrt(covariance(i, i))), closed);
  }
  return table(
      "<th></th><th class=\"number\">value</th><th class=\"number\">standard deviation</th>"
      "<th class=\"number\">closed form</th>",
      rows);
}

std::string error_plot(const LensCalibration& c) {
  PlotSeries errors{"keyframe", "", SeriesKind::kDots, {}};
  for (const auto& fit : c.views)
    errors.points.insert(errors.points.end(), fit.errors_px.begin(), fit.errors_px.end());
  const PlotAxes frame{"Reprojection errors", "error in x, px", "error in y, px", true, false};
  return figure(
      svg_plot(frame, {&errors, 1}),
      fmt::format("Reprojection error of every corner (projected minus detected). RMS {:.3f} px.", c.rms_px));
}

std::string coverage_plot(const LensCalibration& c) {
  PlotSeries corners{"keyframe", "", SeriesKind::kDots, {}}, border{"truth", "", SeriesKind::kLine, {}};
  const double width = c.camera.width, height = c.camera.height;
  border.points = {{0, 0}, {width, 0}, {width, height}, {0, height}, {0, 0}};
  for (const auto& fit : c.views) {
    for (const auto& p : fit.view.pixels) corners.points.emplace_back(p.x(), height - p.y());
  }
  const std::vector<PlotSeries> both = {border, corners};
  const PlotAxes frame{"Coverage of the image", "x, px", "height above the lower edge, px", true, false};
  return figure(
      svg_plot(frame, both),
      fmt::format("Image coverage: corners in {:.0f} % of {} x {} cells, up to {:.0f} % of the image radius.",
                  100 * c.coverage.cells_share, ImageCoverage::kColumns, ImageCoverage::kRows,
                  100 * c.coverage.radius_share));
}

std::string views_table(const LensCalibration& c) {
  double most = 1e-9;
  for (const auto& fit : c.views) most = std::max(most, fit.rms_px);
  std::string rows;
  for (const auto& fit : c.views) {
    const double tilt = std::acos(std::min(1.0, std::abs(fit.T_camera_board.R()(2, 2)))) * kDegrees;
    rows += fmt::format(
        "<tr><td>{}</td><td class=\"number\">{:.3f}</td><td class=\"number\">{:.2f}</td>"
        "<td class=\"number\">{:.0f}</td><td class=\"share\"><i style=\"width:{:.0f}%\"></i></td></tr>",
        escaped_markup(fit.view.name), fit.rms_px, fit.T_camera_board.translation.z(), tilt,
        100 * fit.rms_px / most);
  }
  return table(
      "<th>view</th><th class=\"number\">RMS, px</th><th class=\"number\">distance, m</th>"
      "<th class=\"number\">tilt, &deg;</th><th></th>",
      rows);
}

}  // namespace

json to_json(const LensCalibration& c) {
  json views = json::array();
  for (const auto& fit : c.views) views.push_back({{"name", fit.view.name}, {"rms_px", fit.rms_px}});
  return {{"parameters", parameters_json(c.camera, c.covariance)},
          {"closed_form",
           {{"fx", c.closed_form.fx},
            {"fy", c.closed_form.fy},
            {"cx", c.closed_form.cx},
            {"cy", c.closed_form.cy},
            {"rms_px", c.closed_form_rms_px}}},
          {"rms_px", c.rms_px},
          {"sigma_px", c.sigma_px},
          {"dependence", c.sigma_inflation},
          {"distinct_tilts", c.distinct_tilts},
          {"coverage", {{"cells_share", c.coverage.cells_share}, {"radius_share", c.coverage.radius_share}}},
          {"views", views},
          {"rejected", rejected_json(c.rejected)},
          {"warnings", c.warnings}};
}

json to_json(const RigCalibration& rig) {
  json pairs = json::array();
  for (const auto& p : rig.pairs) {
    pairs.push_back(
        {{"name", p.name}, {"color_rms_px", p.color_rms_px}, {"infrared_rms_px", p.infrared_rms_px}});
  }
  const Eigen::Vector3d r = log_so3(rig.T_color_infrared.rotation);
  const Vector6d deviations = rig.extrinsics_covariance.diagonal().cwiseSqrt();
  json figures = {{"color", parameters_json(rig.color, rig.color_covariance)},
                  {"infrared", parameters_json(rig.infrared, rig.infrared_covariance)},
                  {"T_color_infrared",
                   {{"translation", numbers(rig.T_color_infrared.translation)},
                    {"rotation_vector", numbers(r)},
                    {"deviations", numbers(deviations)}}},
                  {"baseline_m", rig.T_color_infrared.translation.norm()},
                  {"dependence", rig.sigma_inflation},
                  {"pairs", pairs},
                  {"rejected", rejected_json(rig.rejected)}};
  if (rig.color_alone) figures["color_alone"] = to_json(*rig.color_alone);
  if (rig.infrared_alone) figures["infrared_alone"] = to_json(*rig.infrared_alone);
  return figures;
}

json to_json(const DepthShift& shift) {
  json boards = json::array();
  for (const auto& b : shift.boards) {
    boards.push_back({{"name", b.name},
                      {"distance_m", b.distance_m},
                      {"shift_m", b.shift_m},
                      {"spread_m", b.spread_m},
                      {"pixels", b.pixels}});
  }
  return {{"shift_m", shift.shift_m},
          {"deviation_m", shift.sigma_m},
          {"slope", shift.slope},
          {"slope_deviation", shift.slope_sigma},
          {"boards", boards}};
}

std::string to_text(const LensCalibration& c) {
  std::string text =
      fmt::format("{} views, RMS {:.4f} px; closed form alone: fx {:.2f}, fy {:.2f}, RMS {:.3f} px\n",
                  c.views.size(), c.rms_px, c.closed_form.fx, c.closed_form.fy, c.closed_form_rms_px);
  text += parameters_text(c.camera, c.covariance) + rejected_text(c.rejected);
  text += fmt::format(
      "  corners cover {:.0f} % of the image; {} distinct tilts; errors within a view are "
      "correlated: standard deviations x {:.1f}\n",
      100 * c.coverage.cells_share, c.distinct_tilts, c.sigma_inflation);
  return text;
}

std::string to_text(const RigCalibration& rig) {
  const Eigen::Vector3d t = kMm * rig.T_color_infrared.translation;
  const Eigen::Vector3d r = kDegrees * log_so3(rig.T_color_infrared.rotation);
  const Vector6d d = rig.extrinsics_covariance.diagonal().cwiseSqrt();
  std::string text = fmt::format("{} pairs\ncolour\n{}infrared\n{}", rig.pairs.size(),
                                 parameters_text(rig.color, rig.color_covariance),
                                 parameters_text(rig.infrared, rig.infrared_covariance));
  text += fmt::format("infrared to colour\n  translation {:.2f} {:.2f} {:.2f} mm +- {:.2f} {:.2f} {:.2f}\n",
                      t.x(), t.y(), t.z(), kMm * d(0), kMm * d(1), kMm * d(2));
  text += fmt::format("  rotation    {:.3f} {:.3f} {:.3f} deg +- {:.3f} {:.3f} {:.3f}\n", r.x(), r.y(), r.z(),
                      kDegrees * d(3), kDegrees * d(4), kDegrees * d(5));
  text += fmt::format("  baseline    {:.2f} mm; correlated errors: standard deviations x {:.1f}\n",
                      kMm * rig.T_color_infrared.translation.norm(), rig.sigma_inflation);
  return text + rejected_text(rig.rejected);
}

std::string to_text(const DepthShift& shift) {
  std::string text;
  for (const auto& b : shift.boards) {
    text +=
        fmt::format("  {:<24} at {:.3f} m: plane minus measured {:6.1f} mm, spread {:.1f} mm, {} pixels\n",
                    b.name, b.distance_m, kMm * b.shift_m, kMm * b.spread_m, b.pixels);
  }
  text += fmt::format("depth shift {:.1f} mm +- {:.1f}; slope {:.1f} +- {:.1f} mm per metre\n",
                      kMm * shift.shift_m, kMm * shift.sigma_m, kMm * shift.slope, kMm * shift.slope_sigma);
  return text;
}

std::string lens_section(const std::string& title, const LensCalibration& c) {
  std::string warnings;
  for (const auto& w : c.warnings) warnings += fmt::format("<p><b>Warning:</b> {}</p>\n", escaped_markup(w));
  return fmt::format("<h2>{}</h2>\n{}{}<div class=\"pair\">{}{}</div>\n{}{}", escaped_markup(title), warnings,
                     parameter_table(c.camera, c.covariance, &c.closed_form), error_plot(c), coverage_plot(c),
                     views_table(c), rejected_list(c.rejected));
}

std::string rig_section(const RigCalibration& rig) {
  std::string rows;
  for (const auto& p : rig.pairs) {
    rows +=
        fmt::format("<tr><td>{}</td><td class=\"number\">{:.3f}</td><td class=\"number\">{:.3f}</td></tr>",
                    escaped_markup(p.name), p.color_rms_px, p.infrared_rms_px);
  }
  std::string html = "<h2>Both cameras together</h2>\n<pre>" + escaped_markup(to_text(rig)) + "</pre>\n";
  html +=
      table("<th>pair</th><th class=\"number\">RMS colour, px</th><th class=\"number\">RMS infrared, px</th>",
            rows);
  html += rejected_list(rig.rejected);
  if (rig.color_alone) html += lens_section("Colour camera alone", *rig.color_alone);
  if (rig.infrared_alone) html += lens_section("Infrared camera alone", *rig.infrared_alone);
  return html;
}

std::string depth_section(const DepthShift& shift) {
  PlotSeries boards{"keyframe", "", SeriesKind::kDots, {}};
  for (const auto& b : shift.boards) boards.points.emplace_back(b.distance_m, kMm * b.shift_m);
  const PlotAxes frame{"Depth shift over distance", "distance of the board, m", "plane minus measured, mm",
                       false, false};
  return "<h2>Depth</h2>\n" + figure(svg_plot(frame, {&boards, 1}), "One dot per board.") + "<pre>" +
         escaped_markup(to_text(shift)) + "</pre>\n";
}

std::string calibration_page(const std::string& title, const std::string& subtitle,
                             const std::string& sections) {
  return fill_template(
      kHtmlPage,
      {{"title", escaped_markup(title)}, {"subtitle", escaped_markup(subtitle)}, {"body", sections}});
}

}  // namespace kinloop
