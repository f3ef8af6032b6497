#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "common/report/run_summary.hpp"
#include "common/report/text.hpp"

namespace farhand {
namespace {

// Alike for a whole row, so that its points are in line: three digits of the smallest, at most
// three decimals.
int decimals_of(const SummaryRow& row) {
  if (row.count) return 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (const Figures& f : row.runs)
    for (const double v : f.values)
      if (v != 0) smallest = std::min(smallest, std::abs(v * row.scale));
  return std::min(decimals_for(smallest), 3);
}

TableRow table_row(const SummaryRow& row, std::size_t statistics) {
  TableRow out{row.label, row.unit, {}};
  const int decimals = decimals_of(row);
  for (const Figures& f : row.runs) {
    if (f.values.empty()) out.cells.insert(out.cells.end(), statistics, fixed(NAN, 0));
    for (const double v : f.values) out.cells.push_back(fixed(v * row.scale, decimals));
  }
  return out;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  return out + "\"";
}

std::string list(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& t : texts) out += (out.empty() ? "" : ", ") + quoted(t);
  return "[" + out + "]";
}

std::string value(const std::vector<double>& v, const std::vector<std::string>& keys) {
  if (keys.size() == 1) return fmt::format("{:.9g}", v.front());
  std::string out;
  for (std::size_t i = 0; i < v.size(); ++i)
    out += fmt::format("{}\"{}\": {:.9g}", i > 0 ? ", " : "", keys[i], v[i]);
  return "{" + out + "}";
}

}  // namespace

std::vector<Table> tables(const std::vector<SummaryGroup>& groups,
                          const std::vector<std::string>& names) {
  std::vector<Table> out;
  for (const SummaryGroup& g : groups) {
    Table t{g.name, names, g.statistics, {}};
    for (const SummaryRow& row : g.rows) t.rows.push_back(table_row(row, g.statistics.size()));
    out.push_back(std::move(t));
  }
  return out;
}

std::string json(const std::vector<SummaryGroup>& groups, const std::vector<RunData>& runs,
                 const std::vector<std::string>& names) {
  std::string out = "{\n  \"recordings\": [";
  for (std::size_t r = 0; r < runs.size(); ++r) {
    out +=
        fmt::format("{}\n    {{\n      \"name\": {},\n      \"files\": {},\n      \"notes\": {}",
                    r > 0 ? "," : "", quoted(names[r]), list(runs[r].files), list(runs[r].notes));
    for (const SummaryGroup& g : groups)
      for (const SummaryRow& row : g.rows)
        if (!row.runs[r].values.empty())
          out += fmt::format(",\n      {}: {}", quoted(row.key), value(row.runs[r].values, g.keys));
    out += "\n    }";
  }
  return out + "\n  ]\n}\n";
}

}  // namespace farhand
