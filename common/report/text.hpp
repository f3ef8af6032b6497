// Text as a page needs it: escaped, and numbers with as many digits as mean something.
#pragma once

#include <string>
#include <string_view>

namespace farhand {

// & < > " ' as entities: safe as the text of an element and within a quoted attribute.
std::string escape(std::string_view text);

// x with so many decimals, a real minus sign (U+2212), never "-0"; an en dash if x is not finite.
std::string fixed(double x, int decimals);

// Decimals that show x to three significant digits; 0 from 100 on.
int decimals_for(double x);

// x to three significant digits, never fewer than the integer part has; below 0.001 in scientific
// notation.
std::string figure(double x);

// Width [px] that `text` takes at most in a sans-serif font of this size [px]; UTF-8 counts by code
// points.
double text_width(std::string_view text, double size);

}  // namespace farhand
