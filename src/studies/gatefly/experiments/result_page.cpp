// SPDX-License-Identifier: Apache-2.0
#include "gatefly/experiments/result_page.hpp"

#include <algorithm>
#include <cstdint>

#include "gatefly/drawing/palette.hpp"
#include "gatefly/files/base64.hpp"
#include "gatefly/files/jpeg_writer.hpp"
#include "gatefly/sensing/image.hpp"

namespace gatefly::experiments {
namespace {

constexpr const char* kStyle = R"css(
* { box-sizing: border-box; }
html { scroll-behavior: smooth; }
body { margin: 0; background: var(--page); color: var(--ink); font: 16px/1.5 system-ui, sans-serif; font-variant-numeric: tabular-nums; }
body > * { max-width: 1240px; margin-inline: auto; padding-inline: 20px; }
main { padding: 0; }
h1 { margin: 4px auto; font-size: clamp(24px, 3vw, 34px); line-height: 1.2; }
h2 { margin: 0; font-size: 21px; }
a { color: var(--found); } a:focus-visible { outline: 2px solid var(--focus); outline-offset: 2px; }
code { font: 13px/1.5 ui-monospace, "DejaVu Sans Mono", monospace; background: var(--well); border-radius: 5px; padding: 1px 6px; overflow-wrap: anywhere; }
.brand { color: var(--gate); font-weight: 700; padding-top: 18px; }
.lead, .what { color: var(--muted); margin: 2px 0 0; }
.lead { max-width: 1240px; margin-inline: auto; }
nav { display: flex; flex-wrap: wrap; gap: 8px; padding-block: 16px; }
nav a { padding: 3px 12px; border: 1px solid var(--rule); border-radius: 99px; background: var(--panel); text-decoration: none; font-size: 14px; }
section { background: var(--panel); border: 1px solid var(--rule); border-radius: 12px; padding: 20px; margin: 0 auto 20px; width: calc(100% - 24px); max-width: 1216px; scroll-margin-top: 12px; }
.quick { display: inline-block; margin-left: 10px; padding: 1px 10px; border: 1.5px solid var(--warn); border-radius: 6px; color: var(--warn); font-size: 13px; font-weight: 700; vertical-align: 3px; }
.note { border: 1.5px solid var(--warn); border-radius: 8px; color: var(--warn); padding: 8px 14px; margin-block: 14px 0; width: calc(100% - 24px); max-width: 1216px; }
table { border-collapse: collapse; width: 100%; margin: 14px 0 18px; font-size: 14.5px; }
th:nth-child(n+4) { padding-left: 16px; } th { text-align: left; color: var(--muted); font-weight: 500; font-size: 13px; }
th, td { padding: 6px 16px 6px 0; border-bottom: 1px solid var(--rule); vertical-align: top; overflow-wrap: anywhere; }
td:first-child { min-width: 12em; } td.ours { font-weight: 600; }
td.indent { padding-left: 1.2em; }
td.side { border-left: 1px solid var(--rule); padding-left: 16px; padding-right: 0; width: 17em; }
td.side ul { margin: 0; padding-left: 1.1em; } td.side span { color: var(--muted); }
td.side:not(.last) { width: 13em; }
.stay { position: sticky; top: 10px; }
figure { margin: 0 0 14px; } figcaption { color: var(--muted); font-size: 13px; }
img { display: block; max-width: 100%; height: auto; background: #ffffff; border-radius: 8px; border: 1px solid var(--rule); }
footer { color: var(--muted); font-size: 13px; padding-bottom: 30px; }
@media (max-width: 760px) {
  body > * { padding-inline: 14px; } section { padding: 14px; }
  table, tbody, tr, td { display: block; width: auto; } thead { display: none; }
  tr { border-bottom: 1px solid var(--rule); padding: 8px 0; }
  td, td:first-child { border: 0; padding: 1px 0; min-width: 0; } td.indent { padding-left: 1.2em; }
  td:first-child { font-weight: 600; }
  td[data-name]::before { content: attr(data-name) ": "; color: var(--muted); font-weight: 400; }
  td.side, td.side:not(.last) { border: 0; padding: 1px 0; width: auto; } .stay { position: static; display: inline; }
  td.ours { font-weight: 400; } td:empty { display: none; }
}
@media print { section { break-inside: avoid; } nav { display: none; } }
)css";

constexpr const char* kHead = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="generator" content="gatefly reproduce">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>gatefly: paper and ours</title>
<style>
)html";

constexpr const char* kTop = R"html(</style>
</head>
<body>
<div class="brand">gatefly</div>
<h1>Paper and ours</h1>
<p class="lead">Li, Ozo, De Wagter, de Croon: <cite>Autonomous drone race: a computationally efficient vision-based navigation
and control strategy</cite>. Each quantity beside the paper's, where the paper has one; the command that makes it; the sections of
<code>docs/paper/deviations.md</code> that say why it differs.</p>
)html";

constexpr const char* kQuickNote =
    R"html(<p class="note">Quick runs: fewer points and repeats than those of
<code>docs/paper/results.md</code>. They show that everything runs, not how good it is.</p>
)html";

constexpr const char* kFoot = R"html(</main>
<footer>Made by <code>gatefly reproduce</code>. The numbers, and more of them, are in each folder's <code>result.json</code> and
<code>result.csv</code>.</footer>
</body>
</html>
)html";

/// Text as it may stand in an element or a quoted attribute.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out += c;
  }
  return out;
}

std::string code(const std::string& text) { return "<code>" + escaped(text) + "</code>"; }

/// A cell that says its column's name where there is no room for columns.
std::string cell(const std::string& name, const std::string& css_class, const std::string& text) {
  if (text.empty()) return "<td></td>";
  return "<td class=\"" + css_class + "\" data-name=\"" + name + "\">" + escaped(text) + "</td>";
}

/// Beside all rows: it is said once.
std::string side(const std::string& name, const std::string& css_class, std::size_t rows,
                 const std::string& html) {
  return "<td class=\"side" + css_class + "\" data-name=\"" + name + "\" rowspan=\"" +
         std::to_string(rows) + "\"><div class=\"stay\">" + html + "</div></td>";
}

std::string deviations_of(const PageEntry& entry) {
  if (entry.deviations.empty()) return "–";
  std::string html = "<ul>";
  for (const Deviation& deviation : entry.deviations)
    html += "<li>" + escaped(deviation.title) + "<br><span>deviations.md#" +
            escaped(deviation.anchor) + "</span></li>";
  return html + "</ul>";
}

std::string table_of(const PageEntry& entry) {
  std::string html =
      "<table><thead><tr><th scope=\"col\">quantity</th><th scope=\"col\">paper</th><th "
      "scope=\"col\">ours</th><th scope=\"col\">command</th><th "
      "scope=\"col\">deviation</th></tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < entry.table.size(); ++i) {
    const Comparison& row = entry.table[i];
    const std::size_t text = row.what.find_first_not_of(' ');
    html += std::string{"<tr><td"} + (row.what.starts_with(' ') ? " class=\"indent\">" : ">") +
            escaped(text == std::string::npos ? "" : row.what.substr(text)) + "</td>" +
            cell("paper", "paper", row.paper == "-" ? "" : row.paper) +
            cell("ours", "ours", row.ours);
    if (i == 0)
      html += side("command", "", entry.table.size(), code(entry.command)) +
              side("deviation", " last", entry.table.size(), deviations_of(entry));
    html += "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

std::string figure_of(const PagePicture& picture, const PageEntry& entry, bool embedded) {
  const std::string caption = "<figcaption>" + code(picture.file) +
                              (embedded ? "" : ": too large for this page, lies beside it") +
                              "</figcaption>";
  if (!embedded) return "<figure>" + caption + "</figure>\n";
  return "<figure><img loading=\"lazy\" width=\"" + std::to_string(picture.width) + "\" height=\"" +
         std::to_string(picture.height) + "\" alt=\"" +
         escaped("Plot of " + entry.name + ": " + entry.what) + "\" src=\"" + picture.data_uri +
         "\">" + caption + "</figure>\n";
}

std::string section_of(const PageEntry& entry, std::size_t largest) {
  std::string html = "<section id=\"" + escaped(entry.name) + "\">\n<h2>" + escaped(entry.name) +
                     (entry.quick ? "<span class=\"quick\">quick run</span>" : "") +
                     "</h2>\n<p class=\"what\">" + escaped(entry.what) + "</p>\n" + table_of(entry);
  for (const PagePicture& picture : entry.pictures)
    html += figure_of(picture, entry, picture.data_uri.size() <= largest);
  return html + "</section>\n";
}

/// So many bytes may a picture have that all together are few enough.
std::size_t largest_embedded(std::span<const PageEntry> entries) {
  constexpr std::size_t kWords = 400'000;  // of tables and style
  std::vector<std::size_t> sizes;
  for (const PageEntry& entry : entries)
    for (const PagePicture& picture : entry.pictures) sizes.push_back(picture.data_uri.size());
  std::sort(sizes.begin(), sizes.end());
  std::size_t sum = 0, largest = 0;
  for (const std::size_t size : sizes) {
    if ((sum += size) > kMostPageBytes - kWords) break;
    largest = size;
  }
  return largest;
}

PagePicture page_picture(std::string file, const drawing::Canvas& canvas) {
  const std::vector<std::uint8_t> rgb = canvas.rgb();
  const Image image(rgb.data(), PixelFormat::kRgb, canvas.width(), canvas.height());
  const std::string png = canvas.png(), jpeg = files::small_jpeg(image, 82);
  return {.file = std::move(file),
          .width = canvas.width(),
          .height = canvas.height(),
          .data_uri = png.size() <= 2 * jpeg.size()  // curves stay sharp as PNG
                          ? "data:image/png;base64," + files::base64(png)
                          : "data:image/jpeg;base64," + files::base64(jpeg)};
}

}  // namespace

PageEntry entry_of(const Experiment& experiment, const Result& result, const std::string& command) {
  PageEntry entry{.name = experiment.name,
                  .what = experiment.what,
                  .command = command,
                  .quick = result.json.value("quick", false),
                  .table = result.table,
                  .deviations = experiment.deviations,
                  .pictures = {page_picture(experiment.name + "/plot.png", result.picture)}};
  for (const ExtraPicture& extra : result.extra)
    entry.pictures.push_back(
        page_picture(experiment.name + "/" + extra.name + ".png", extra.picture));
  return entry;
}

std::string result_page(std::span<const PageEntry> entries) {
  const bool quick = std::any_of(entries.begin(), entries.end(),
                                 [](const PageEntry& entry) { return entry.quick; });
  std::string links, sections;
  const std::size_t largest = largest_embedded(entries);
  for (const PageEntry& entry : entries) {
    links += "<a href=\"#" + escaped(entry.name) + "\">" + escaped(entry.name) + "</a>\n";
    sections += section_of(entry, largest);
  }
  std::string html = kHead;
  html += ":root { color-scheme: light dark; " + drawing::css_of(drawing::kLight) + " }\n";
  html +=
      "@media (prefers-color-scheme: dark) { :root { " + drawing::css_of(drawing::kDark) + " } }";
  html += kStyle;
  html += kTop;
  if (quick) html += kQuickNote;
  html += "<nav aria-label=\"experiments\">\n" + links + "</nav>\n<main>\n";
  return html + sections + kFoot;
}

}  // namespace gatefly::experiments
