#include <gtest/gtest.h>

#include <cmath>

#include "common/report/text.hpp"

namespace farhand {
namespace {

TEST(Escape, LeavesNothingThatMarkupCouldMistake) {
  EXPECT_EQ(escape("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(escape("</title><script>"), "&lt;/title&gt;&lt;script&gt;");
}

TEST(Fixed, HasARealMinusAndNoNegativeZero) {
  EXPECT_EQ(fixed(-1.25, 1), "\u22121.2");
  EXPECT_EQ(fixed(-0.001, 2), "0.00");
  EXPECT_EQ(fixed(NAN, 2), "\u2013");
}

TEST(Figure, HasThreeSignificantDigits) {
  EXPECT_EQ(figure(0.26349), "0.263");
  EXPECT_EQ(figure(9.996), "10.0");
  EXPECT_EQ(figure(123456), "123456");
  EXPECT_EQ(figure(-2.112), "\u22122.11");
  EXPECT_EQ(figure(0), "0");
  EXPECT_EQ(figure(1.234e-5), "1.23e-05");
}

TEST(TextWidth, CountsCodePointsNotBytes) {
  EXPECT_EQ(text_width("\u00b5", 10), text_width("u", 10));
}

}  // namespace
}  // namespace farhand
