#!/usr/bin/env bash
# A teleoperation over DTLS while a stranger floods it with datagrams that no partner would send, kind by kind; beside it one
# that is left alone. Motion must go on, and the stranger gets no record of data and no more bytes than it gave.
#
#   master (simulated hand) ---- 127.0.0.1 ---- slave (simulated arm) <---- farhand-flood
#
# The scene bears gaps of STALE_MS, 250, since a busy machine stops for 100 ms of its own. Prints what it cost; asserts no time.
# Usage: flood.sh BIN_DIR [SECONDS [RATE [STALE_MS]]]
set -euo pipefail
cd "$(dirname "$0")/../.."

bin="$1" seconds="${2:-30}" rate="${3:-20000}" stale_ms="${4:-250}"
source tests/loop/programs.sh
port=$((20000 + RANDOM % 20000))
"$bin/farhand-keygen" "$dir/link.key" >/dev/null
{ sed 's/^duration_s: 60/duration_s: 3600/' tests/loop/presses.textproto | sed '/press {/d'; echo "link { key_file: \"link.key\" stale_ms: $stale_ms }"; } \
  >"$dir/scene.textproto"

# used PROGRAM: milliseconds of processor time that it has had.
used() { awk -v hz="$(getconf CLK_TCK)" '{ print ($14 + $15) * 1000 / hz }' "/proc/${!1}/stat"; }
# row PROGRAM NAME FIELD: that field of the table's row, counted from its end; told PROGRAM TEXT: the number behind the text.
row() { awk -v name="  $2" -v back="$3" 'index($0, name) == 1 { print $(NF - back) }' "$dir/$1"; }
told() { sed -nE "s/.*$2 ([0-9.]+).*/\1/p" "$dir/$1" | tail -n 1; }

# while_running COMMAND...: teleoperates as long as COMMAND runs; leaves the figures in $line, the slave's milliseconds in $cost.
while_running() {
  start slave "$dir/scene.textproto" --quiet --listen "127.0.0.1:$port"
  start master "$dir/scene.textproto" --quiet --slave "127.0.0.1:$port" --listen "127.0.0.1:$((port + 1))"
  wait_for slave 'READY -> ENGAGED' 1
  wait_for master 'READY -> ENGAGED' 1
  local before
  before="$(used slave)"
  "$@" >"$dir/flood" || fail "farhand-flood: $(cat "$dir/flood")"
  cost="$(awk -v a="$(used slave)" -v b="$before" 'BEGIN { print a - b }')"
  held="$(($(count master 'ENGAGED -> ') + $(count slave 'ENGAGED -> ')))"
  interrupted=$((interrupted + held))
  end INT master slave
  line="$(printf '%9s mm %6s mm %6s %10s %6s %10s us %8s us %10.1f ms' "$(told slave 'tracking free *')" "$(told slave 'mm rms *')" \
    "$held" "$(told slave overruns)" "$(told slave lost)" "$(row master 'motion to force' 3)" "$(row master 'motion to force' 2)" \
    "$({ row master 'woken late' 0; row slave 'woken late' 0; } | sort -g | awk 'END { print $1 / 1000 }')")"
}

interrupted=0
echo "$seconds s each, $rate datagrams a second, gaps of $stale_ms ms borne"
printf '%-20s %22s %6s %10s %6s %24s %13s\n' '' 'tracking rms, peak' held overruns lost 'motion to force p50, p99' 'worst wake-up'
while_running sleep "$seconds"
quiet="$cost"
printf '%-20s %s\n' 'left alone' "$line"
for kind in noise record hello; do
  while_running "$bin/farhand-flood" --to "127.0.0.1:$port" --kind "$kind" --rate "$rate" --duration "$seconds"
  read -r bytes heard data < <(flood_bytes)
  said="$(told flood said)"
  printf '%-20s %s   %.2f us a datagram, %s said, dropped %s, %s bytes back for %s\n' "$kind to the slave" "$line" \
    "$(awk -v a="$cost" -v b="$quiet" -v n="$said" 'BEGIN { print (a - b) * 1000 / n }')" "$said" "$(told slave dropped)" "$heard" "$bytes"
  ((heard <= bytes && data == 0)) || fail "the stranger got $heard bytes for $bytes, $data records of data"
done
while_running "$bin/farhand-flood" --to "127.0.0.1:$((port + 1))" --kind any --rate "$rate" --duration "$seconds"
printf '%-20s %s\n' 'any to the master' "$line"
((interrupted == 0)) || fail "motion was interrupted $interrupted times"
pass "motion went on under every flood"
echo "$passed passed, 0 failed"
