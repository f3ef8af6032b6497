// A page in one file: tables and charts, readable without script, without a request to anywhere.
#pragma once

#include <string>
#include <vector>

#include "common/report/chart.hpp"

namespace farhand {

struct TableRow {
  std::string label;
  std::string unit;
  std::vector<std::string> cells;  // the headings of the first block, of the second...
};

// Blocks of columns (one per recording), each with the same headings.
struct Table {
  std::string caption;
  std::vector<std::string> blocks;
  std::vector<std::string> headings;
  std::vector<TableRow> rows;
};

// Charts of one subject, side by side where there is room.
struct ChartRow {
  std::string heading;
  std::string explanation;
  std::vector<Chart> charts;  // fitted
  std::vector<Table> tables;  // below the charts
};

struct Page {
  std::string title;
  std::vector<std::string> facts;     // lines under the title
  std::vector<std::string> warnings;  // what a reader must know first
  std::vector<Table> tables;
  std::string before_charts;  // HTML, a legend that all charts share
  std::vector<ChartRow> rows;
};

// Everything but before_charts is text and is escaped here.
std::string html(const Page& page);

}  // namespace farhand
