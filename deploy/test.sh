#!/usr/bin/env bash
# Installs, builds and runs all tests. With a preset's name (dev, release, asan, tsan) those of that build; dev otherwise.
set -euo pipefail
cd "$(dirname "$0")/.."

preset="${1:-dev}"
deploy/install.sh --tests
cmake --preset "$preset" -DFARHAND_TESTS=ON >/dev/null
cmake --build --preset "$preset"
ctest --preset "$preset" --no-tests=error -j "$(nproc)"

# GoogleTest counts a skipped test as passed: say which, and why.
log="build/$preset/Testing/Temporary/LastTest.log"
grep -A1 ': Skipped$' "$log" || true
echo "skipped tests: $(grep -c '^\[  SKIPPED \] .*(' "$log" || true)"
