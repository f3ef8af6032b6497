#!/usr/bin/env bash
# farhand-slave and farhand-master as two processes over UDP on this machine:
#
#   master (simulated hand) ---- 127.0.0.1 ---- slave (simulated arm)
#
# Each case waits for what the programs say, with generous time-outs; none asserts a time. Usage: two_processes.sh BIN_DIR
set -euo pipefail
cd "$(dirname "$0")/../.."

bin="$1"
scene=tests/loop/presses.textproto
port=$((20000 + RANDOM % 20000))
dir="$(mktemp -d)"
passed=0
trap 'kill -9 $(jobs -p) 2>/dev/null || true; rm -rf "$dir"' EXIT

# SIGKILL is part of the test: bash need not tell.
set +m
start_slave() { "$bin/farhand-slave" "${1:-$scene}" --quiet --listen "127.0.0.1:$port" >"$dir/slave" 2>&1 & slave=$!; }
start_master() { "$bin/farhand-master" "${1:-$scene}" --quiet --slave "127.0.0.1:$port" >"$dir/master" 2>&1 & master=$!; }

fail() {
  echo "FAILED: $*"
  tail -n 30 "$dir"/slave "$dir"/master
  exit 1
}
pass() {
  passed=$((passed + 1))
  echo "ok: $*"
}
# wait_for FILE PATTERN COUNT: until FILE has PATTERN at least COUNT times, 20 s at most.
wait_for() {
  for _ in $(seq 200); do
    (($(grep -c -- "$2" "$dir/$1" || true) >= $3)) && return
    sleep 0.1
  done
  fail "$1 never said '$2' $3 times"
}
# Ends both sides in order and waits for their tables.
stop_both() {
  kill "-$1" "$master" "$slave"
  wait "$master" || fail "the master's exit status was $?"
  wait "$slave" || fail "the slave's exit status was $?"
}
mode_lines() { grep -o -- '[A-Z]* -> [A-Z]*' "$dir/$1" || true; }

for signal in INT TERM; do
  start_slave
  start_master
  wait_for slave 'READY -> ENGAGED' 2
  wait_for master 'READY -> ENGAGED' 2
  stop_both "$signal"
  grep -q 'dropped 0' "$dir/master" || fail "the master dropped datagrams"
  grep -q 'tracking free' "$dir/slave" || fail "the slave's table has no tracking"
  pass "engages at each press, ends in order on SIG$signal"
done

start_slave
start_master
wait_for slave 'READY -> ENGAGED' 1
kill -9 "$master"
wait "$master" 2>/dev/null || true
wait_for slave 'ENGAGED -> HOLDING' 1
wait_for slave 'HOLDING -> IDLE' 1
before="$(grep -c 'ENGAGED$' "$dir/slave" || true)"
start_master
wait_for slave 'IDLE -> READY' 2
wait_for slave 'READY -> ENGAGED' $((before + 1))
mode_lines slave | grep -qE '(IDLE|HOLDING) -> ENGAGED' && fail "the slave engaged without a release"
stop_both INT
pass "kill -9 of the master: the robot is held, then ready for a new master, and moves only after a new press"

start_slave
start_master
wait_for master 'READY -> ENGAGED' 1
kill -9 "$slave"
wait "$slave" 2>/dev/null || true
wait_for master 'ENGAGED -> HOLDING' 1
wait_for master 'HOLDING -> IDLE' 1
start_slave
wait_for master 'IDLE -> READY' 2
wait_for master 'READY -> ENGAGED' 2
mode_lines master | grep -qE '(IDLE|HOLDING) -> ENGAGED' && fail "the master engaged without a release"
stop_both INT
pass "kill -9 of the slave: the force fades, the master is ready again when it returns, and engages only after a new press"

start_slave
start_master
wait_for master 'READY -> ENGAGED' 1
for i in $(seq 2000); do printf 'garbage %d \x00\xff<>' "$i" >"/dev/udp/127.0.0.1/$port" || true; done
wait_for slave 'READY -> ENGAGED' 2
stop_both INT
grep -q 'ENGAGED -> HOLDING' "$dir/slave" && fail "garbage stopped the slave"
dropped="$(sed -n 's/.*dropped \([0-9]*\),.*/\1/p' "$dir/slave")"
((dropped >= 1000)) || fail "2000 garbage datagrams, $dropped dropped"
pass "garbage from a stranger is dropped and counted ($dropped), motion goes on"

sed 's/^slave {/link { stale_ms: 30 }\nslave {/' "$scene" >"$dir/other.textproto"
start_slave
start_master "$dir/other.textproto"
wait_for master 'no answer from the slave' 1
wait_for slave 'another scene' 1
stop_both INT
[[ -z "$(mode_lines slave)" && -z "$(mode_lines master)" ]] || fail "sides with different scenes left IDLE"
pass "different scenes: the slave says so, the master that nobody answers, and both stay idle"

# keyed NAME: the scene with $dir/NAME.key.
keyed() {
  { echo "link { key_file: \"$1.key\" }"; cat "$scene"; } >"$dir/$1.textproto"
  echo "$dir/$1.textproto"
}
"$bin/farhand-keygen" "$dir/one.key" >/dev/null
"$bin/farhand-keygen" "$dir/two.key" >/dev/null
"$bin/farhand-keygen" "$dir/one.key" >/dev/null 2>&1 && fail "farhand-keygen overwrote a key"
one="$(keyed one)"

start_slave "$one"
start_master "$one"
wait_for slave 'READY -> ENGAGED' 1
wait_for master 'READY -> ENGAGED' 1
before="$(grep -c 'ENGAGED$' "$dir/slave" || true)"
kill -9 "$master"
wait "$master" 2>/dev/null || true
start_master "$one"
wait_for slave 'READY -> ENGAGED' $((before + 1))
before="$(grep -c 'ENGAGED$' "$dir/master" || true)"
kill -9 "$slave"
wait "$slave" 2>/dev/null || true
start_slave "$one"
wait_for master 'READY -> ENGAGED' $((before + 1))
wait_for slave 'READY -> ENGAGED' 1
mode_lines master | grep -qE '(IDLE|HOLDING) -> ENGAGED' && fail "the master engaged without a release"
stop_both INT
for side in master slave; do
  grep -q "key $(sed -n 's/^# Farhand key \([0-9a-f]*\).*/\1/p' "$dir/one.key")" "$dir/$side" || fail "the $side did not name its key"
done
pass "with one key: engages, and again after kill -9 of either side"

start_slave "$one"
start_master "$(keyed two)"
wait_for master 'the slave has another key than this side' 1
wait_for slave 'a master that would connect has another key' 1
wait_for master 'no answer from the slave' 1
stop_both INT
[[ -z "$(mode_lines slave)" && -z "$(mode_lines master)" ]] || fail "sides with different keys left IDLE"
grep -q 'farhand-keygen' "$dir/slave" || fail "the slave names no remedy"
pass "different keys: both sides say so and stay idle"

start_slave "$one"
start_master
wait_for master 'no answer from the slave' 1
stop_both INT
[[ -z "$(mode_lines slave)" && -z "$(mode_lines master)" ]] || fail "a master without the key was heard"
pass "a master without a key is not heard by a slave that has one"

chmod 644 "$dir/two.key"
start_master "$(keyed two)"
wait "$master" && fail "a key that all may read was taken"
grep -q 'chmod 600' "$dir/master" || fail "the master does not say what to do about the open key"
"$bin/farhand-slave" "$scene" --quiet --listen "0.0.0.0:$port" >"$dir/slave" 2>&1 && fail "a plain link beyond this machine was taken"
grep -q 'farhand-keygen' "$dir/slave" || fail "the slave does not say how to leave this machine"
pass "an open key file and a plain link to the world are refused, with the remedy"

# A disk of 1 MiB where that can be mounted out of everybody's sight, else a limit on the size of files.
mkdir "$dir/disk"
if unshare --mount mount -t tmpfs -o size=1m none "$dir/disk" 2>/dev/null; then
  small=(unshare --mount bash -c "mount -t tmpfs -o size=1m none '$dir/disk'"' && "$@"; s=$?; cp '"'$dir/disk/run.mcap' '$dir'; exit \$s" -)
else
  small=(bash -c 'ulimit -f 1024 && "$@"; s=$?; cp '"'$dir/disk/run.mcap' '$dir'; exit \$s" -)
fi
"$bin/farhand-slave" "$scene" --quiet --listen "127.0.0.1:$port" --record /dev/full >"$dir/slave" 2>&1 & slave=$!
"${small[@]}" "$bin/farhand-master" "$scene" --quiet --slave "127.0.0.1:$port" --duration 8 --record "$dir/disk/run.mcap" \
  >"$dir/master" 2>&1 & master=$!
wait "$master" || fail "the master's exit status was $?"
kill -INT "$slave"
wait "$slave" || fail "the slave's exit status was $?"
for side in master slave; do
  grep -qE 'recording lost [1-9].*(No space|too large)' "$dir/$side" || fail "the $side did not say that records were lost"
  grep -q 'records lost' "$dir/$side" && fail "the $side lost ticks on their way to the disk"
  grep -q 'READY -> ENGAGED' "$dir/$side" || fail "the $side did not engage"
done
"$bin/farhand-loopback" --replay "$dir/run.mcap" >"$dir/replay" 2>&1 || { cat "$dir/replay"; fail "what fitted cannot be replayed"; }
grep -q 'ENGAGED [1-9]' "$dir/replay" || fail "the replay did not engage"
pass "full disks cost records ($(grep -o 'lost [0-9]* of [0-9]*' "$dir/master")), no tick; what fitted is replayed"

echo "$passed passed, 0 failed"
