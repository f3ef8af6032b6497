#include "common/report/svg_chart.hpp"

#include <spdlog/fmt/fmt.h>

#include <iterator>
#include <utility>

#include "common/report/chart_style.hpp"
#include "common/report/svg_path.hpp"
#include "common/report/text.hpp"
#include "common/report/ticks.hpp"

namespace farhand {
namespace {

// Of the layout [px].
constexpr double kLeft = 62, kRight = 14, kBottom = 40, kGap = 12;
constexpr double kTitle = 22, kRow = 17, kStripRow = 11, kStripHeight = 8;
constexpr double kTickEachX = 62, kTickEachY = 26;
constexpr double kFont = 12;

struct Box {
  double left = 0, top = 0, right = 0, bottom = 0;
};

template <typename... Args>
void put(std::string& out, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(out), format, std::forward<Args>(args)...);
}

struct LegendEntry {
  std::string name;
  int style = 0;
  bool level = false;
  bool markers = false;
};

std::vector<LegendEntry> legend(const Chart& chart) {
  std::vector<LegendEntry> entries;
  bool any_level = false;
  for (const Panel& panel : chart.panels) {
    any_level = any_level || !panel.levels.empty();
    for (const Line& line : panel.lines) {
      const auto same = [&](const LegendEntry& e) { return e.name == line.name; };
      if (!line.name.empty() && std::none_of(entries.begin(), entries.end(), same))
        entries.push_back({line.name, line.style, false, line.markers});
    }
  }
  if (any_level && !chart.level_name.empty()) entries.push_back({chart.level_name, 0, true, false});
  return entries.size() > 1 ? entries : std::vector<LegendEntry>{};
}

// The mark of a style about (x, y): a disc, square, triangle, diamond, bar or lying bar.
void mark(std::string& out, int style, double x, double y) {
  static constexpr const char* kShapes[kLineStyles] = {
      "m-3.5 0a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0",
      "m-3-3h6v6h-6z",
      "m0-4l4 7h-8z",
      "m0-4.5l4.5 4.5l-4.5 4.5l-4.5-4.5z",
      "m-1.5-4h3v8h-3z",
      "m-4-1.5h8v3h-8z"};
  put(out, "M{:.1f} {:.1f}{}", x, y, kShapes[style % kLineStyles]);
}

void draw_legend_entry(std::string& out, const LegendEntry& e, double x, double y) {
  if (e.level)
    put(out, "<path class=\"level\" d=\"M{:.0f} {:.0f}h26\"/>", x, y);
  else
    put(out, "<g transform=\"scale(.1)\"><path class=\"line l{}\" d=\"M{:.0f} {:.0f}h260\"/></g>",
        e.style % kLineStyles, 10 * x, 10 * y);
  if (e.markers) {
    put(out, "<path class=\"m{}\" d=\"", e.style % kLineStyles);
    mark(out, e.style, x + 13, y);
    out += "\"/>";
  }
  put(out, "<text x=\"{:.0f}\" y=\"{:.0f}\">{}</text>", x + 32, y + 4, escape(e.name));
}

// Entries wrap within the chart's width. Returns the height used.
double draw_legend(std::string& out, const Chart& chart, double top) {
  double x = kLeft, y = top;
  const std::vector<LegendEntry> entries = legend(chart);
  if (entries.empty()) return 0;
  for (const LegendEntry& e : entries) {
    const double width = 32 + text_width(e.name, kFont) + 14;
    if (x > kLeft && x + width > chart.width) x = kLeft, y += kRow;
    draw_legend_entry(out, e, x, y + kRow / 2);
    x += width;
  }
  return y + kRow - top;
}

// A rectangle per span, at least a pixel wide, as one path per shade.
void draw_spans(std::string& out, const std::vector<Span>& spans, const PixelScale& x, double top,
                double height, const char* only_class) {
  for (int shade = 0; shade < kShades; ++shade) {
    std::string d;
    for (const Span& s : spans) {
      if (s.shade != shade || s.hi < x.lo || s.lo > x.hi) continue;
      const double from = x(s.lo), width = std::max(x(s.hi) - from, 1.0);
      put(d, "M{:.1f} {:.1f}h{:.1f}v{:.1f}h{:.1f}z", from, top, width, height, -width);
    }
    if (d.empty()) continue;
    put(out, "<path class=\"{}\" d=\"{}\"/>",
        only_class != nullptr ? std::string(only_class) : fmt::format("s{}", shade), d);
  }
}

struct Frame {
  Box box;
  PixelScale x, y;
  bool tick_labels_x = true;
};

std::vector<Tick> ticks(const PixelScale& scale, double each) {
  const int most = std::max(2, static_cast<int>(std::abs(scale.to - scale.from) / each));
  return scale.log ? log_ticks(scale.lo, scale.hi, most) : linear_ticks(scale.lo, scale.hi, most);
}

// Labels that would touch the one before are left out (the ends of a logarithmic axis).
struct LabelRoom {
  double next = -1e9;
  bool take(double centre, double width) {
    if (centre - width / 2 < next) return false;
    next = centre + width / 2 + 4;
    return true;
  }
};

void draw_x_ticks(std::string& out, const Frame& f) {
  std::string major, minor;
  LabelRoom room;
  for (const Tick& t : ticks(f.x, kTickEachX)) {
    const double px = f.x(t.at);
    put(t.label.empty() ? minor : major, "M{:.1f} {:.1f}V{:.1f}", px, f.box.top, f.box.bottom);
    if (f.tick_labels_x && !t.label.empty() && room.take(px, text_width(t.label, 11)))
      put(out, "<text class=\"tick mid\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", px,
          f.box.bottom + 14, t.label);
  }
  if (!minor.empty()) put(out, "<path class=\"minor\" d=\"{}\"/>", minor);
  if (!major.empty()) put(out, "<path class=\"grid\" d=\"{}\"/>", major);
}

void draw_y_ticks(std::string& out, const Frame& f) {
  std::string major, minor;
  for (const Tick& t : ticks(f.y, kTickEachY)) {
    const double px = f.y(t.at);
    put(t.label.empty() ? minor : major, "M{:.1f} {:.1f}H{:.1f}", f.box.left, px, f.box.right);
    if (!t.label.empty())
      put(out, "<text class=\"tick end\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", f.box.left - 5,
          px + 4, t.label);
  }
  if (!minor.empty()) put(out, "<path class=\"minor\" d=\"{}\"/>", minor);
  if (!major.empty()) put(out, "<path class=\"grid\" d=\"{}\"/>", major);
}

void draw_labels(std::string& out, const Frame& f, const Panel& panel) {
  const double middle = (f.box.top + f.box.bottom) / 2, left = f.box.left - kLeft + 13;
  put(out, "<text class=\"mid\" transform=\"translate({:.1f} {:.1f}) rotate(-90)\">{}</text>", left,
      middle, escape(panel.y.label));
  if (f.tick_labels_x)
    put(out, "<text class=\"mid\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
        (f.box.left + f.box.right) / 2, f.box.bottom + 31, escape(panel.x.label));
  if (!panel.note.empty())
    put(out, "<text class=\"note end\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", f.box.right - 4,
        f.box.top + 13, escape(panel.note));
}

void draw_lines(std::string& out, const Frame& f, const Panel& panel) {
  out += "<g transform=\"scale(.1)\">";
  for (const Line& line : panel.lines) {
    const std::string d = path(line.points, f.x, f.y);
    if (!d.empty()) put(out, "<path class=\"line l{}\" d=\"{}\"/>", line.style % kLineStyles, d);
  }
  out += "</g>";
  for (const Line& line : panel.lines) {
    if (!line.markers) continue;
    put(out, "<path class=\"m{}\" d=\"", line.style % kLineStyles);
    for (const Point& p : line.points)
      if (f.x.shows(p.x) && f.y.shows(p.y)) mark(out, line.style, f.x(p.x), f.y(p.y));
    out += "\"/>";
  }
}

void draw_panel(std::string& out, const Frame& f, const Panel& panel,
                const std::vector<Span>& shaded) {
  const Box& b = f.box;
  draw_spans(out, shaded, f.x, b.top, b.bottom - b.top, "shade");
  draw_y_ticks(out, f);
  draw_x_ticks(out, f);
  std::string levels;
  for (const double level : panel.levels)
    if (level >= f.y.lo && level <= f.y.hi)
      put(levels, "M{:.1f} {:.1f}H{:.1f}", b.left, f.y(level), b.right);
  if (!levels.empty()) put(out, "<path class=\"level\" d=\"{}\"/>", levels);
  draw_lines(out, f, panel);
  put(out, "<path class=\"frame\" d=\"M{:.1f} {:.1f}V{:.1f}H{:.1f}\"/>", b.left, b.top, b.bottom,
      b.right);
  draw_labels(out, f, panel);
}

void widen(PixelScale& scale, double units_per_pixel) {
  const double middle = 0.5 * (scale.lo + scale.hi);
  const double half = 0.5 * units_per_pixel * std::abs(scale.to - scale.from);
  scale.lo = middle - half;
  scale.hi = middle + half;
}

Frame frame(const Chart& chart, std::size_t i, double top) {
  const auto columns = static_cast<std::size_t>(chart.columns);
  const std::size_t row = i / columns, column = i % columns;
  const double pitch_x = (chart.width - kRight + kGap) / static_cast<double>(columns);
  const double pitch_y = chart.panel_height + (chart.shared_x ? kGap : kBottom + kGap);
  Frame f;
  f.box.left = pitch_x * static_cast<double>(column) + kLeft;
  f.box.right = pitch_x * static_cast<double>(column + 1) - kGap;
  f.box.top = top + pitch_y * static_cast<double>(row);
  f.box.bottom = f.box.top + chart.panel_height;
  const Panel& panel = chart.panels[i];
  f.x = {panel.x.lo, panel.x.hi, panel.x.log, f.box.left, f.box.right};
  f.y = {panel.y.lo, panel.y.hi, panel.y.log, f.box.bottom, f.box.top};
  f.tick_labels_x = !chart.shared_x || i + columns >= chart.panels.size();
  if (chart.equal_aspect) {
    const double upp =
        std::max((f.x.hi - f.x.lo) / (f.x.to - f.x.from), (f.y.hi - f.y.lo) / (f.y.from - f.y.to));
    widen(f.x, upp);
    widen(f.y, upp);
  }
  return f;
}

double draw_strips(std::string& out, const Chart& chart, double top) {
  if (chart.strips.empty() || chart.panels.empty()) return 0;
  const Frame f = frame(chart, 0, 0);
  double y = top;
  for (const Strip& strip : chart.strips) {
    put(out, "<text class=\"strip end\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", kLeft - 5, y + 8,
        escape(strip.label));
    draw_spans(out, strip.spans, f.x, y, kStripHeight, nullptr);
    y += kStripRow;
  }
  return y + 3 - top;
}

}  // namespace

std::string svg(const Chart& chart) {
  std::string body;
  put(body, "<text class=\"title\" x=\"2\" y=\"15\">{}</text>", escape(chart.title));
  double y = kTitle;
  if (!chart.subtitle.empty()) {
    put(body, "<text class=\"sub\" x=\"2\" y=\"{:.0f}\">{}</text>", y + 9, escape(chart.subtitle));
    y += kRow;
  }
  y += draw_legend(body, chart, y) + 4;
  y += draw_strips(body, chart, y);
  double bottom = y;
  for (std::size_t i = 0; i < chart.panels.size(); ++i) {
    const Frame f = frame(chart, i, y);
    draw_panel(body, f, chart.panels[i], chart.shaded);
    bottom = std::max(bottom, f.box.bottom);
  }
  if (!has_data(chart))
    put(body, "<text class=\"mid\" x=\"{}\" y=\"{:.0f}\">not recorded</text>", chart.width / 2,
        (y + bottom) / 2);
  return fmt::format(
      "<svg class=\"chart\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1:.0f}\" "
      "width=\"{0}\" height=\"{1:.0f}\" role=\"img\" aria-label=\"{2}\">{3}</svg>\n",
      chart.width, bottom + kBottom, escape(chart.title), body);
}

std::string standalone_svg(Chart chart) {
  fit_axes({&chart, 1});
  std::string out = svg(chart);
  const std::size_t inside = out.find('>') + 1;
  out.insert(inside, fmt::format("<style>{}</style><rect width=\"100%\" height=\"100%\" "
                                 "style=\"fill:var(--paper)\"/>",
                                 chart_style()));
  return out;
}

}  // namespace farhand
