#include "common/report/svg_path.hpp"

#include <spdlog/fmt/fmt.h>

#include <iterator>
#include <optional>

namespace farhand {
namespace {

struct Pixel {
  long x = 0, y = 0;  // tenths
};

// One run of drawable points at a time; holds back the last, which a horizontal run may swallow.
class PathWriter {
 public:
  void add(Pixel p) {
    if (!pen_) {
      move(p);
    } else if (held_ && held_->y == pen_->y && p.y == pen_->y && forward(p)) {
      held_ = p;
    } else {
      flush();
      held_ = p;
    }
  }
  void lift() {
    flush();
    pen_.reset();
  }
  std::string take() {
    flush();
    return std::move(out_);
  }

 private:
  bool forward(Pixel p) const { return (held_->x >= pen_->x) == (p.x >= held_->x); }
  void move(Pixel p) {
    fmt::format_to(std::back_inserter(out_), "M{} {}", p.x, p.y);
    pen_ = p;
  }
  void flush() {
    if (!held_) return;
    const long dx = held_->x - pen_->x, dy = held_->y - pen_->y;
    if (dy == 0 && dx != 0)
      fmt::format_to(std::back_inserter(out_), "h{}", dx);
    else if (dx == 0 && dy != 0)
      fmt::format_to(std::back_inserter(out_), "v{}", dy);
    else if (dx != 0)
      fmt::format_to(std::back_inserter(out_), "l{}{}{}", dx, dy < 0 ? "" : " ", dy);
    pen_ = held_;
    held_.reset();
  }

  std::string out_;
  std::optional<Pixel> pen_, held_;
};

}  // namespace

std::string path(std::span<const Point> points, const PixelScale& x, const PixelScale& y) {
  PathWriter writer;
  for (const Point& p : points) {
    if (x.shows(p.x) && y.shows(p.y))
      writer.add({std::lround(10 * x(p.x)), std::lround(10 * y(p.y))});
    else
      writer.lift();
  }
  return writer.take();
}

}  // namespace farhand
