#include <gtest/gtest.h>

#include <cmath>

#include "common/report/svg_chart.hpp"
#include "common/report/svg_path.hpp"

namespace farhand {
namespace {

Chart one_line(std::vector<Point> points) {
  Chart c{.title = "t"};
  c.panels.push_back({.x = {.label = "time [s]"}, .y = {.label = "y [mm]"}});
  c.panels[0].lines.push_back({"line", 0, std::move(points)});
  return c;
}

TEST(SvgPath, IsRelativeTenthsOfPixelsAndSkipsHorizontalRuns) {
  const PixelScale x{0, 10, false, 0, 100}, y{0, 10, false, 100, 0};
  const std::vector<Point> points{{0, 0}, {1, 0}, {2, 0}, {3, 5}, {4, NAN}, {5, 1}, {6, 2}};
  EXPECT_EQ(path(points, x, y), "M0 1000h200l100-500M500 900l100-100");
}

TEST(SvgPath, OfALogarithmicAxisLeavesOutWhatIsNotPositive) {
  const PixelScale x{0, 2, false, 0, 20}, y{1, 100, true, 0, 20};
  const std::vector<Point> points{{0, 1}, {1, 0}, {2, 100}};
  EXPECT_EQ(path(points, x, y), "M0 0M200 200");
}

TEST(FitAxes, ChartsSideBySideShareTheirAxes) {
  std::vector<Chart> charts{one_line({{0, 1}, {10, 2}}), one_line({{0, -3}, {20, 1}})};
  fit_axes(charts);
  for (const Chart& c : charts) {
    EXPECT_EQ(c.panels[0].x.lo, 0);
    EXPECT_EQ(c.panels[0].x.hi, 20);
    EXPECT_LT(c.panels[0].y.lo, -3);
    EXPECT_GT(c.panels[0].y.hi, 2);
    EXPECT_GT(c.panels[0].y.lo, -4);
  }
}

TEST(FitAxes, ALimitShowsOnceTheDataComeNear) {
  std::vector<Chart> far{one_line({{0, 1}, {1, 2}})}, near{one_line({{0, 1}, {1, 6}})};
  far[0].panels[0].levels = near[0].panels[0].levels = {10};
  fit_axes(far);
  fit_axes(near);
  EXPECT_LT(far[0].panels[0].y.hi, 10);
  EXPECT_GT(near[0].panels[0].y.hi, 10);
}

TEST(FitAxes, AConstantSignalGetsItsLeastSpan) {
  std::vector<Chart> c{one_line({{0, 5}, {1, 5}})};
  c[0].panels[0].y.least = 2;
  fit_axes(c);
  EXPECT_LE(c[0].panels[0].y.lo, 4);
  EXPECT_GE(c[0].panels[0].y.hi, 6);
}

TEST(Svg, EscapesEveryText) {
  Chart c = one_line({{0, 0}, {1, 1}});
  c.title = c.subtitle = c.panels[0].y.label = c.panels[0].x.label = c.panels[0].note = "<&\">";
  c.panels[0].lines.push_back({"<&\">", 1, {{0, 1}, {1, 0}}});
  c.strips = {{"<&\">", {}}};
  const std::string out = standalone_svg(c);
  EXPECT_EQ(out.find("<&"), std::string::npos);
  EXPECT_NE(out.find("&lt;&amp;&quot;&gt;"), std::string::npos);
}

TEST(Svg, ALegendNamesLinesWhenThereIsMoreThanOne) {
  Chart c = one_line({{0, 0}, {1, 1}});
  EXPECT_EQ(standalone_svg(c).find(">line<"), std::string::npos);
  c.panels[0].lines.push_back({"other", 1, {{0, 1}, {1, 0}}});
  EXPECT_NE(standalone_svg(c).find(">line<"), std::string::npos);
  EXPECT_NE(standalone_svg(c).find(">other<"), std::string::npos);
}

TEST(Svg, LogLogPointsAreMarkedAndConnected) {
  Chart c = one_line({{1, 10}, {10, 100}, {100, 1000}});
  c.panels[0].x.log = c.panels[0].y.log = true;
  c.panels[0].lines[0].markers = true;
  const std::string out = standalone_svg(c);
  EXPECT_NE(out.find("class=\"m0\""), std::string::npos);
  EXPECT_NE(out.find("class=\"line l0\""), std::string::npos);
  EXPECT_NE(out.find(">100<"), std::string::npos);
}

TEST(Svg, WithoutDataSaysSo) {
  EXPECT_NE(standalone_svg(one_line({})).find("not recorded"), std::string::npos);
}

TEST(StepOutline, GoesAroundTheBinsThatHoldSomething) {
  const std::vector<double> edges{1, 2, 3, 4, 5}, counts{0, 7, 0, 2};
  const auto p = step_outline(edges, counts);
  ASSERT_EQ(p.size(), 8u);
  EXPECT_EQ(p.front().x, 2);
  EXPECT_EQ(p[1].y, 7);
  EXPECT_EQ(p[3].y, 0.5);
  EXPECT_EQ(p.back().x, 5);
}

}  // namespace
}  // namespace farhand
