// The figures a run is told by, as rows that a page and JSON are both written from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/report/html_page.hpp"
#include "common/report/run_data.hpp"

namespace farhand {

// One quantity of one run. Either three statistics, of which the group says the names, or one
// value; nothing if it was not recorded.
struct Figures {
  std::vector<double> values;  // SI
};

struct SummaryRow {
  std::string key;     // in JSON, with the SI unit
  std::string label;   // on the page
  std::string unit;    // on the page
  double scale = 1;    // from SI to that unit
  bool count = false;  // a number of something: no decimals
  std::vector<Figures> runs;
};

struct SummaryGroup {
  std::string name;
  std::vector<std::string> statistics;  // names of the three on the page
  std::vector<std::string> keys;        // and in JSON
  std::vector<SummaryRow> rows;
};

// Rows that no run has a value for are left out, as are empty groups.
std::vector<SummaryGroup> summarize(const std::vector<RunData>& runs);

// One per group; `names` head the runs' columns.
std::vector<Table> tables(const std::vector<SummaryGroup>& groups,
                          const std::vector<std::string>& names);

// {"recordings": [{"name": ..., "files": [...], "notes": [...], "<key>": {"rms": ...} or number}]};
// numbers with 9 digits, what was not recorded is left out.
std::string json(const std::vector<SummaryGroup>& groups, const std::vector<RunData>& runs,
                 const std::vector<std::string>& names);

}  // namespace farhand
