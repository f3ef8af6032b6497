#include "common/report/html_page.hpp"

#include <spdlog/fmt/fmt.h>

#include "common/report/chart_style.hpp"
#include "common/report/svg_chart.hpp"
#include "common/report/text.hpp"

namespace farhand {
namespace {

constexpr std::string_view kPageStyle = R"(
*{box-sizing:border-box}
body{margin:0 auto;padding:20px 24px 40px;max-width:1440px;background:var(--paper);color:var(--ink);
font:14px/1.45 system-ui,"Segoe UI",Roboto,"Helvetica Neue",Arial,sans-serif}
h1{font-size:24px;line-height:1.2;margin:0 0 4px}
h2{font-size:18px;margin:30px 0 2px}
p{margin:2px 0}.facts,.about{color:var(--soft)}.about{max-width:75em;margin-bottom:8px}
.warning{border-left:4px solid var(--s5);padding:4px 10px;margin:10px 0;background:var(--shade)}
.tables{display:grid;gap:0 36px;align-items:start;margin-top:14px}
.tables.narrow{display:block;columns:2 500px;column-gap:36px}
.scroll{overflow-x:auto;break-inside:avoid;margin:0 0 14px}
table{border-collapse:collapse;width:100%;table-layout:fixed;font-variant-numeric:tabular-nums}
caption{text-align:left;font-weight:600;padding:2px 0}
th{font-weight:400;text-align:left;vertical-align:top}thead th{color:var(--soft);text-align:right;vertical-align:bottom}
thead th.block{color:var(--ink);font-weight:600;overflow-wrap:anywhere}
td{text-align:right;white-space:nowrap}
th,td{padding:2px 0 2px 8px}th:first-child{padding-left:0}
tbody tr{border-top:1px solid var(--rule)}thead tr:last-child{border-bottom:1px solid var(--frame)}
td.next{border-left:1px solid var(--rule)}
.unit{color:var(--soft)}
.key{display:flex;flex-wrap:wrap;gap:4px 18px;color:var(--soft);font-size:13px;margin:4px 0}
.key svg{width:22px;height:10px;vertical-align:0;margin-right:5px}
.charts{display:grid;gap:18px 24px;justify-items:center}
figure{margin:0;width:100%;break-inside:avoid}
figure svg{display:block;width:100%;height:auto;margin:0 auto;overflow:visible}
@media print{@page{size:landscape;margin:10mm}.charts{grid-template-columns:1fr 1fr!important;gap:8px 16px}.tables.narrow{columns:2}body{padding:0;font-size:11px;max-width:none}
section{break-inside:avoid}h2,.about{break-after:avoid}h2{margin-top:14px}}
)";

void put_head(std::string& out, const Table& t) {
  out += "<thead>";
  if (t.blocks.size() > 1) {
    out += "<tr><th></th>";
    for (const std::string& block : t.blocks)
      out += fmt::format("<th class=\"block\" scope=\"colgroup\" colspan=\"{}\">{}</th>",
                         t.headings.size(), escape(block));
    out += "</tr>";
  }
  const bool named = t.headings.size() > 1;
  if (named) out += "<tr><th></th>";
  for (std::size_t b = 0; named && b < t.blocks.size(); ++b)
    for (const std::string& heading : t.headings)
      out += fmt::format("<th scope=\"col\">{}</th>", escape(heading));
  out += named ? "</tr></thead>" : "</thead>";
}

void put_row(std::string& out, const TableRow& row, std::size_t block) {
  out += fmt::format("<tr><th scope=\"row\">{}", escape(row.label));
  if (!row.unit.empty()) out += fmt::format(" <span class=\"unit\">[{}]</span>", escape(row.unit));
  out += "</th>";
  for (std::size_t i = 0; i < row.cells.size(); ++i)
    out += fmt::format("<td{}>{}</td>", i > 0 && i % block == 0 ? " class=\"next\"" : "",
                       escape(row.cells[i]));
  out += "</tr>";
}

void put_table(std::string& out, const Table& t) {
  // Label column, then equal ones; fixed, so that the columns of tables one below another meet.
  constexpr std::size_t kLabelWidth = 230;
  const std::size_t columns = t.blocks.size() * t.headings.size();
  out += fmt::format(
      "<div class=\"scroll\"><table style=\"min-width:{}px\"><colgroup><col style=\"width:{}px\">"
      "<col span=\"{}\"></colgroup><caption>{}</caption>",
      kLabelWidth + 64 * columns, kLabelWidth, columns, escape(t.caption));
  put_head(out, t);
  out += "<tbody>";
  for (const TableRow& row : t.rows) put_row(out, row, t.headings.size());
  out += "</tbody></table></div>\n";
}

void put_tables(std::string& out, const std::vector<Table>& tables) {
  const bool narrow = tables.empty() || tables.front().blocks.size() <= 2;
  out += narrow ? "<div class=\"tables narrow\">\n" : "<div class=\"tables\">\n";
  for (const Table& table : tables) put_table(out, table);
  out += "</div>\n";
}

void put_charts(std::string& out, const ChartRow& row) {
  const int width = row.charts.empty() ? 640 : row.charts.front().width;
  out += fmt::format("<section><h2>{}</h2>\n<p class=\"about\">{}</p>\n", escape(row.heading),
                     escape(row.explanation));
  out += fmt::format(
      "<div class=\"charts\" style=\"grid-template-columns:"
      "repeat(auto-fit,minmax(min(100%,{}px),1fr))\">\n",
      width * 9 / 10);
  for (const Chart& chart : row.charts)
    out +=
        fmt::format("<figure style=\"max-width:{}px\">{}</figure>\n", width * 11 / 10, svg(chart));
  out += "</div>\n";
  if (!row.tables.empty()) put_tables(out, row.tables);
  out += "</section>\n";
}

void put_paragraphs(std::string& out, const char* css_class,
                    const std::vector<std::string>& lines) {
  for (const std::string& line : lines)
    out += fmt::format("<p class=\"{}\">{}</p>\n", css_class, escape(line));
}

}  // namespace

std::string html(const Page& page) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>\n{1}{2}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
      escape(page.title), chart_style(), kPageStyle);
  put_paragraphs(out, "facts", page.facts);
  put_paragraphs(out, "warning", page.warnings);
  put_tables(out, page.tables);
  out += page.before_charts;
  for (const ChartRow& row : page.rows) put_charts(out, row);
  return out + "</body>\n</html>\n";
}

}  // namespace farhand
