#!/usr/bin/env bash
# Instructions per tick of each side's core, counted by callgrind, and what composing a tick of optional stages costs against
# the same work written as a straight line. Fails above 2 %. Usage: instructions.sh BIN_DIR
set -euo pipefail
cd "$(dirname "$0")/../.."

cost="$1/farhand-tick-cost"
smallest=deploy/scenes/minimal.textproto
full=deploy/scenes/full.textproto
worst_ratio=1.02

skip() {
  echo "skipped: $*"
  exit 77
}
command -v valgrind >/dev/null || skip "valgrind is not installed"
"$cost" "$smallest" check 1000 1000 || exit $?

# instructions SCENE PART FROM: of a tick, a mean over 1000 of them.
instructions() {
  valgrind --tool=callgrind --instr-atstart=no --callgrind-out-file=/dev/null "$cost" "$1" "$2" "$3" 1000 2>&1 |
    awk '/Collected/ { printf "%.1f\n", $NF / 1000 }'
}

failed=0
printf '%-8s %16s %16s %8s %16s %16s %12s\n' side 'smallest scene' 'straight line' ratio 'without record' 'handed over' 'full scene'
for side in master slave; do
  product="$(instructions "$smallest" "$side" 1000)"
  straight="$(instructions "$smallest" "straight-$side" 1000)"
  bare="$(instructions "$smallest" "bare-$side" 1000)"
  handed="$(instructions "$smallest" "recorded-$side" 1000)"  # to the recorder, as every loop does, with --record or not
  all="$(instructions "$full" "$side" 6500)"  # pressing on the wall
  ratio="$(awk "BEGIN { printf \"%.4f\", $product / $straight }")"
  printf '%-8s %16s %16s %8s %16s %16s %12s\n' "$side" "$product" "$straight" "$ratio" "$bare" "$handed" "$all"
  awk "BEGIN { exit !($ratio <= $worst_ratio) }" || failed=1
done
echo '(instructions per tick, without link, device and plant)'
((failed == 0)) || { echo "FAILED: composition costs more than 2 %"; exit 1; }
