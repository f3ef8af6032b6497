#!/usr/bin/env bash
# How near the two programs come to what this machine allows. In turn, over and over: the floor, the programs, the floor again.
#
#   round trip   from the handle's sample to its force, both programs over DTLS, less the simulated plants, against
#                udp_pingpong in block mode; both ends on one core, then on two, there also with realtime { spin_us: 200 }
#   wake-up      lateness of the master's loop against loop_jitter in sleep mode
#
# SCHED_FIFO where that is permitted. Prints medians [us] and the median of the ratios pair by pair; asserts nothing.
# Usage: link_ratios.sh BIN_DIR REFERENCE_DIR [PAIRS [SECONDS]]; REFERENCE_DIR holds udp_pingpong.c and loop_jitter.c.
set -euo pipefail
cd "$(dirname "$0")/../.."

bin="$1" references="$2" pairs="${3:-15}" seconds="${4:-4}"
source tests/loop/programs.sh
port=$((20000 + RANDOM % 20000))
ticks=$((1000 * seconds))
for name in udp_pingpong loop_jitter; do cc -O2 -o "$dir/$name" "$references/$name.c" -lm; done
"$bin/farhand-keygen" "$dir/link.key" >/dev/null
sed 's/^link {/link { key_file: "link.key"/' deploy/scenes/twin_delta_contact.textproto >"$dir/scene.textproto"
sed 's/^\(master\|slave\) {/& realtime { spin_us: 200 }/' "$dir/scene.textproto" >"$dir/spin.textproto"

median() { sort -g | awk '{ v[NR] = $1 } END { print (v[int((NR + 1) / 2)] + v[int(NR / 2) + 1]) / 2 }'; }
p50() { grep -o 'p50[ =][0-9.]*' | grep -o '[0-9.]*$'; }
# row PROGRAM NAME: the median in that row of its table.
row() { awk -v name="  $2 " 'index($0, name) == 1 { print $(NF - 3) }' "$dir/$1"; }

# Each appends its figure to the file named by its first argument.
pingpong() {  # FILE CORE CORE
  "$dir/udp_pingpong" -S -m block -p "$port" -c "$3" -f 80 2>/dev/null &
  local server=$!
  sleep 0.2
  "$dir/udp_pingpong" -C -m block -a 127.0.0.1 -p "$port" -r 1000 -n "$ticks" -c "$2" -f 80 2>/dev/null | p50 >>"$1"
  kill "$server" && wait "$server" 2>/dev/null || true
}
jitter() {  # FILE CORE
  "$dir/loop_jitter" -m sleep -f 80 -n "$ticks" -c "$2" 2>/dev/null | p50 >>"$1"
}
programs() {  # FILE CORE CORE WOKEN_FILE [SCENE]
  local scene="$dir/${5:-scene}.textproto"
  at_master=(taskset -c "$2") at_slave=(taskset -c "$3")
  start slave "$scene" --quiet --listen "127.0.0.1:$port"
  start master "$scene" --quiet --slave "127.0.0.1:$port" --duration "$seconds"
  wait "$master" || fail "the master's exit status was $?"
  end INT slave
  awk -v all="$(row master 'motion to force')" -v read="$(row slave 'read device')" -v write="$(row slave 'write device')" \
    'BEGIN { print all - read - write }' >>"$1"
  row master 'woken late' >>"$4"
}

# against NAME FLOOR OURS FLOOR_AGAIN: a row of the table.
against() {
  local again ours
  ours="$(paste "$3" "$2" | awk '{ print $1 / $2 }' | median)"
  again="$(paste "$4" "$2" | awk '{ print $1 / $2 }' | median)"
  printf '%-22s %8.1f %8.1f %8.2f %12.2f   %.1f..%.1f\n' "$1" "$(median <"$2")" "$(median <"$3")" "$ours" "$again" \
    "$(sort -g "$2" "$4" | head -n 1)" "$(sort -g "$2" "$4" | tail -n 1)"
}

for ((i = 0; i < pairs; ++i)); do
  for other in 0 1; do
    pingpong "$dir/floor$other" 0 "$other"
    programs "$dir/ours$other" 0 "$other" "$dir/woken$other"
    pingpong "$dir/again$other" 0 "$other"
  done
  programs "$dir/spun" 0 1 "$dir/spun_woken" spin
  jitter "$dir/sleep" 0
  jitter "$dir/sleep_again" 0
done

printf '%-22s %8s %8s %8s %12s   %s\n' "$pairs pairs, p50 [us]" floor ours ratio 'floor/floor' "the floor's range"
against 'round trip, one core' "$dir"/{floor0,ours0,again0}
against 'round trip, two cores' "$dir"/{floor1,ours1,again1}
against 'the same, spinning' "$dir"/{floor1,spun,again1}
against 'wake-up, one core' "$dir"/{sleep,woken0,sleep_again}
against 'wake-up, two cores' "$dir"/{sleep,woken1,sleep_again}
echo "load at the end: $(cut -d ' ' -f 1-3 /proc/loadavg)"
