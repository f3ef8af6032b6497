#!/usr/bin/env bash
# The long stress runs: 10^8 faulty ticks of each scene, 10^9 ticks of every controller (with a number, that many of each): about
# an hour on one core. By name:
#   cuts [N]               the link cut 10 000 times at random moments
#   sim [N]                2000 seeds of faults under virtual time, 30 s each
#   sim hours [N]          100 simulated hours of them
#   hosts [N]              both programs on two hosts through every harm, five side by side, N (10) times over: some 12 minutes
#   flood [SECONDS [RATE [STALE_MS]]]
#                          a teleoperation flooded by a stranger, 30 s of each kind, RATE datagrams a second; it bears gaps of STALE_MS
#   fuzz [SECONDS]         each fuzz target for ten minutes; what it finds is in build/fuzz
set -euo pipefail
cd "$(dirname "$0")/.."

deploy/install.sh --tests
if [[ "${1:-}" == fuzz ]]; then
  cmake --preset fuzz -DFARHAND_TESTS=ON >/dev/null
  cmake --build --preset fuzz
  for target in build/fuzz/bin/*_fuzz; do
    name="$(basename "$target" _fuzz)"
    mkdir -p "build/fuzz/corpus/$name"
    echo "== $name"
    "$target" "build/fuzz/corpus/$name" -max_total_time="${2:-600}" -artifact_prefix="build/fuzz/$name-" -print_final_stats=1
  done
  exit
fi
cmake --preset release -DFARHAND_TESTS=ON >/dev/null
if [[ "${1:-}" == hosts ]]; then
  cmake --build --preset release --target farhand-master farhand-slave farhand-impair
  exec tests/loop/two_hosts.sh build/release/bin "${2:-10}" 5
fi
if [[ "${1:-}" == flood ]]; then
  cmake --build --preset release --target farhand-master farhand-slave farhand-keygen farhand-flood
  exec tests/loop/flood.sh build/release/bin "${2:-30}" "${3:-20000}" "${4:-250}"
fi
if [[ "${1:-}" == sim ]]; then
  cmake --build --preset release --target farhand-sim
  mkdir -p build/sim
  seeds="${2:-2000}"
  [[ "$seeds" == hours ]] && seeds=$((120 * ${3:-100}))   # of 30 s
  exec build/release/bin/farhand-sim --seeds "1:$seeds" --record build/sim
fi
if [[ "${1:-}" == cuts ]]; then
  cmake --build --preset release --target loop_link_cut_test
  FARHAND_STRESS_TICKS="${2:-10000}" exec build/release/bin/loop_link_cut_test
fi
cmake --build --preset release --target stress_ticks_test stress_controllers_test
FARHAND_STRESS_TICKS="${1:-100000000}" build/release/bin/stress_ticks_test
FARHAND_STRESS_TICKS="${1:-1000000000}" build/release/bin/stress_controllers_test
