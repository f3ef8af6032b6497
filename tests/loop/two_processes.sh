#!/usr/bin/env bash
# farhand-slave and farhand-master as two processes over UDP on this machine:
#
#   master (simulated hand) ---- 127.0.0.1 ---- slave (simulated arm)
#   master ---- 127.0.0.1 ---- relay ---- 127.0.0.1 ---- slave
#
# Each case waits for what the programs say, with generous time-outs; none asserts a time. The parts that do little but wait run
# side by side, what loads the machine alone after them. Usage: two_processes.sh BIN_DIR
set -euo pipefail
cd "$(dirname "$0")/../.."

logs="$(mktemp -d)" running=() failed=0 port=$((20000 + RANDOM % 20000))
trap 'kill $(jobs -p) 2>/dev/null || true; wait; rm -rf "$logs"' EXIT
for part in link trust several; do
  "tests/loop/two_processes/$part.sh" "$1" "$port" >"$logs/$part" 2>&1 &
  running+=($!)
  port=$((port + 3))
done
for part in "${running[@]}"; do wait "$part" || failed=1; done
cat "$logs"/*
((failed == 0)) || exit 1
tests/loop/two_processes/load.sh "$1" "$port" 2>&1 | tee "$logs/load"
echo "$(cat "$logs"/* | grep -c '^ok: ') passed, 0 failed"
