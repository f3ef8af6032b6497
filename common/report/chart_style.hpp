// The colours and strokes of all charts, as CSS. Okabe and Ito's colours, told apart by the dash
// pattern too; light and dark follow the reader's preference, print is light.
#pragma once

#include <string_view>

namespace farhand {

std::string_view chart_style();

}  // namespace farhand
