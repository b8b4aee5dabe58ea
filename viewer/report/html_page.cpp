#include "viewer/report/html_page.hpp"

#include <cmath>

namespace kinloop {

const char* const kHtmlPage = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{{title}} - kinloop</title>
<style>
:root {
  --page: #f7f7f4; --card: #ffffff; --ink: #1c1d1f; --soft: #62656b; --line: #e3e3de;
  --estimate: #2563c4; --loop: #d9601a; --bar: #2563c4;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #141517; --card: #1d1f22; --ink: #ececea; --soft: #a0a3a9; --line: #303338;
    --estimate: #6aa3f5; --loop: #f0894a; --bar: #6aa3f5;
  }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
main { max-width: 1120px; margin: 0 auto; padding: 24px 16px 48px; }
h1 { font-size: 26px; line-height: 1.2; margin: 0; overflow-wrap: anywhere; }
h2 { font-size: 18px; margin: 36px 0 10px; }
p { margin: 6px 0; }
.soft, figcaption { color: var(--soft); font-size: 14px; }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(148px, 1fr)); gap: 10px; margin-top: 20px; }
.tile, figure, .table { background: var(--card); border: 1px solid var(--line); border-radius: 8px; }
.tile { padding: 10px 14px 12px; }
.tile b { display: block; font-size: 23px; font-weight: 600; line-height: 1.3; white-space: nowrap; }
.tile small { color: var(--soft); font-size: 13px; display: block; line-height: 1.35; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 420px), 1fr)); gap: 14px; }
figure { margin: 0; padding: 12px 14px; min-width: 0; }
figcaption { margin-top: 4px; }
svg { display: block; width: 100%; height: auto; }
svg text { fill: var(--soft); font: 12px system-ui, sans-serif; }
svg path { fill: none; stroke-linejoin: round; stroke-linecap: round; }
.grid { stroke: var(--line); stroke-width: 1; }
.truth { stroke: var(--soft); stroke-width: 2; }
.estimate, .error { stroke: var(--estimate); stroke-width: 1.5; }
.loop, .level { stroke: var(--loop); stroke-width: 1.5; }
.level { stroke-dasharray: 5 4; }
.keyframe { fill: var(--estimate); }
.bar { fill: var(--bar); }
.table { overflow-x: auto; padding: 6px 14px; }
table { border-collapse: collapse; width: 100%; font-size: 14px; font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 500; color: var(--soft); }
th, td { padding: 5px 14px 5px 0; border-bottom: 1px solid var(--line); white-space: nowrap; }
tr:last-child td { border-bottom: 0; }
.number { text-align: right; }
td.share { width: 40%; min-width: 90px; }
td.share i { display: block; height: 10px; border-radius: 0 3px 3px 0; background: var(--bar); min-width: 1px; }
pre { margin: 0; white-space: pre-wrap; font-size: 13px; }
@media print {
  :root { --page: #ffffff; --card: #ffffff; --ink: #000000; --soft: #444444; --line: #cccccc;
          --estimate: #2563c4; --loop: #d9601a; --bar: #2563c4; }
  body { font-size: 11pt; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  main { max-width: none; padding: 0; }
  figure, .tile, tr { break-inside: avoid; }
  h2 { break-after: avoid; }
  .pair { grid-template-columns: 1fr 1fr; }
}
</style>
</head>
<body>
<main>
<h1>{{title}}</h1>
<p class="soft">{{subtitle}}</p>
{{body}}
</main>
</body>
</html>
)html";

std::string format_with_thousands(double number) {
  constexpr size_t kGroup = 3;
  std::string digits = std::to_string(std::llround(std::abs(number)));
  for (size_t at = digits.size(); at > kGroup; at -= kGroup) digits.insert(at - kGroup, "&#8239;");
  return (number < 0 ? "-" : "") + digits;
}

std::string fill_template(std::string_view page,
                          const std::map<std::string, std::string, std::less<>>& values) {
  constexpr std::string_view kOpen = "{{", kClose = "}}";
  std::string filled;
  while (true) {
    const size_t open = page.find(kOpen);
    const size_t close = page.find(kClose, open);
    filled += page.substr(0, open);
    if (open == std::string_view::npos || close == std::string_view::npos) return filled;
    const auto value = values.find(page.substr(open + kOpen.size(), close - open - kOpen.size()));
    if (value != values.end()) filled += value->second;
    page.remove_prefix(close + kClose.size());
  }
}

}  // namespace kinloop
