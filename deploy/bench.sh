#!/usr/bin/env bash
# Run time against error of every part, beside others that do the same: deploy/docs/benches.md.
#   bench.sh [--quick | --long]       installs, builds, measures on one core: build/bench/bench.html and bench.json
#   bench.sh --compare OLD NEW        what became slower or less accurate between two bench.json
set -euo pipefail
cd "$(dirname "$0")/.."

bin=build/release/bin
build() {
  deploy/install.sh --bench
  cmake --preset release -DFARHAND_TESTS=ON -DFARHAND_BENCH=ON >/dev/null
  cmake --build --preset release --target "$@"
}
if [[ "${1:-}" == --compare ]]; then
  build bench-report >/dev/null
  exec "$bin/bench-report" --compare "${2:?OLD}" "${3:?NEW}"
fi

build farhand_benches farhand-tick-cost
out=build/bench
core=$(($(nproc) - 1))
mkdir -p "$out"
rm -rf "$out"/*.json "$out/scenes"

files=()
for subject in kinematics handles dynamics pid wire link tick; do
  echo "$subject" >&2
  taskset -c "$core" "$bin/bench-$subject" "$@" --out "$out/$subject.json"
  files+=("$out/$subject.json")
done

# Instructions of the same ticks; callgrind counts alike whatever else runs.
"$bin/bench-tick" --scenes "$out/scenes"
cp deploy/scenes/{minimal,twin_delta_free,falcon_arm,twin_delta_contact,full}.textproto "$out/scenes"
count() {  # SUBJECT CONTENDER SCENE PART
  local counted
  counted="$(valgrind --tool=callgrind --instr-atstart=no --callgrind-out-file=/dev/null \
    "$bin/farhand-tick-cost" "$3" "$4" 6500 1000 2>&1 | awk '/Collected/ { print $NF / 1000 }')"
  printf '{"subject": "%s", "contender": "%s", "set": "%s", "instructions": %s}' \
    "$1" "$2" "$(basename "$3" .textproto)" "$counted"
}
{
  echo '{"instructions": ['
  for scene in "$out"/scenes/*.textproto; do
    for side in master slave; do count "tick, $side" Farhand "$scene" "$side"; echo ,; done
  done
  count 'tick, master' 'straight line' "$out/scenes/minimal.textproto" straight-master; echo ,
  count 'tick, slave' 'straight line' "$out/scenes/minimal.textproto" straight-slave
  echo ']}'
} >"$out/instructions.json"

"$bin/bench-report" --out "$out" "${files[@]}" "$out/instructions.json" \
  --fact "revision $(git describe --always --dirty), preset release (portable -O3), on core $core of $(nproc)"
echo "$out/bench.html"
