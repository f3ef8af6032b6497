#include "common/report/chart_style.hpp"

namespace farhand {

std::string_view chart_style() {
  // Strokes are in tenths of a pixel: lines are drawn in a group scaled by 0.1.
  return R"(:root{color-scheme:light dark;
--paper:#fff;--card:#fff;--ink:#1a1a1a;--soft:#5c5c5c;--grid:#e4e4e4;--frame:#9a9a9a;--rule:#dcdcdc;
--c0:#0072b2;--c1:#d55e00;--c2:#009e73;--c3:#cc79a7;--c4:#e69f00;--c5:#56b4e9;
--s0:#d5d5d5;--s1:#56b4e9;--s2:#e69f00;--s3:#009e73;--s4:#444;--s5:#d55e00;--shade:#00000010}
@media screen and (prefers-color-scheme:dark){:root{
--paper:#14171a;--card:#1b1f23;--ink:#e8e8e8;--soft:#a3a9af;--grid:#31373d;--frame:#6b747c;--rule:#343b42;
--c0:#56b4e9;--c1:#e69f00;--c2:#00b887;--c3:#cc79a7;--c4:#f0e442;--c5:#d55e00;
--s0:#4a5056;--s1:#3a8fc4;--s2:#e69f00;--s3:#00b887;--s4:#d0d0d0;--s5:#ff7a1a;--shade:#ffffff12}}
svg.chart{font:12px system-ui,"Segoe UI",Roboto,"Helvetica Neue",Arial,sans-serif;fill:var(--ink)}
.chart .title{font-size:14px;font-weight:600}
.chart .sub,.chart .tick,.chart .note,.chart .strip{fill:var(--soft);font-size:11px}
.chart .tick,.chart .note{font-variant-numeric:tabular-nums}
.chart .strip{font-size:10px}
.chart .end{text-anchor:end}.chart .mid{text-anchor:middle}
.chart .grid{stroke:var(--grid);fill:none}.chart .minor{stroke:var(--grid);fill:none;opacity:.5}
.chart .frame{stroke:var(--frame);fill:none}
.chart .shade{fill:var(--shade)}
.chart .level{stroke:var(--c1);stroke-dasharray:2 3;stroke-width:1.3;fill:none}
.chart .line{fill:none;stroke-width:15;stroke-linejoin:round}
.chart .l0{stroke:var(--c0)}.chart .l1{stroke:var(--c1);stroke-dasharray:70 25}
.chart .l2{stroke:var(--c2);stroke-dasharray:25 20}.chart .l3{stroke:var(--c3);stroke-dasharray:110 25 25 25}
.chart .l4{stroke:var(--c4);stroke-dasharray:150 30}.chart .l5{stroke:var(--c5);stroke-dasharray:60 20 15 20 15 20}
.chart .m0{fill:var(--c0)}.chart .m1{fill:var(--c1)}.chart .m2{fill:var(--c2)}
.chart .m3{fill:var(--c3)}.chart .m4{fill:var(--c4)}.chart .m5{fill:var(--c5)}
.s0{fill:var(--s0)}.s1{fill:var(--s1)}.s2{fill:var(--s2)}.s3{fill:var(--s3)}.s4{fill:var(--s4)}.s5{fill:var(--s5)}
)";
}

}  // namespace farhand
