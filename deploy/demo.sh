#!/usr/bin/env bash
# The loopback teleoperation demo, no hardware: installs, builds, and runs farhand-slave and farhand-master as two processes over
# UDP on this machine for about 20 s. A simulated hand moves the twin-delta handle; the arm follows, and then presses on a
# surface whose force comes back to the hand. Leaves both recordings and a report of them in build/demo.
#   deploy/demo.sh [SCENE]
set -euo pipefail
cd "$(dirname "$0")/.."

scene="${1:-deploy/scenes/twin_delta_contact.textproto}"
seconds=20

deploy/install.sh
cmake --preset release -DFARHAND_TESTS=OFF -DCMAKE_UNITY_BUILD=ON >/dev/null
cmake --build --preset release --target farhand-master farhand-slave farhand-report

out=build/demo
mkdir -p "$out"
slave_log="$(mktemp)"
build/release/bin/farhand-slave "$scene" --quiet --record "$out/slave.mcap" >"$slave_log" &
slave=$!
trap 'kill "$slave" 2>/dev/null || true; rm -f "$slave_log"' EXIT

echo "running $scene for $seconds s"
build/release/bin/farhand-master "$scene" --duration "$seconds" --record "$out/master.mcap"
kill -INT "$slave"
wait "$slave"
cat "$slave_log"
build/release/bin/farhand-report "$out/master.mcap" "$out/slave.mcap" -o "$out/report.html"
echo "report: $out/report.html"
