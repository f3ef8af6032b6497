#!/usr/bin/env bash
# Presses, kill -9 of either side, strangers' datagrams, another scene, and the relay between.
# Usage: link.sh BIN_DIR PORT
set -euo pipefail
cd "$(dirname "$0")/../../.."

bin="$1" port="$2"
source tests/loop/two_processes/both.sh

for signal in INT TERM; do
  start_slave
  start_master
  wait_for slave 'READY -> ENGAGED' 2
  wait_for master 'READY -> ENGAGED' 2
  end "$signal" master slave
  grep -q 'dropped 0' "$dir/master" || fail "the master dropped datagrams"
  grep -q 'tracking free' "$dir/slave" || fail "the slave's table has no tracking"
  pass "engages at each press, ends in order on SIG$signal"
done

# What is killed is engaged then, however late the kill comes: the first press lasts.
held="$dir/held.textproto"
sed -e 's/at_s: 1 lasting_s: 1 /at_s: 1 lasting_s: 3.5 /' -e '/at_s: 3 lasting_s/d' "$scene" >"$held"

start_slave
start_master "$held"
wait_for slave 'READY -> ENGAGED' 1
kill_hard master
wait_for slave 'ENGAGED -> HOLDING' 1
wait_for slave 'HOLDING -> DISCONNECTED' 1
before="$(count slave 'ENGAGED$')"
start_master
wait_for slave '\(SYNCING\|ALIGNING\|DISCONNECTED\) -> READY' 2
wait_for slave 'READY -> ENGAGED' $((before + 1))
engaged_only_by_a_press
end INT master slave
pass "kill -9 of the master: the robot is held, then ready for a new master, and moves only after a new press"

start_slave
start_master "$held"
wait_for master 'READY -> ENGAGED' 1
kill_hard slave
wait_for master 'ENGAGED -> HOLDING' 1
wait_for master 'HOLDING -> DISCONNECTED' 1
start_slave
wait_for master '\(SYNCING\|ALIGNING\|DISCONNECTED\) -> READY' 2
wait_for master 'READY -> ENGAGED' 2
engaged_only_by_a_press
end INT master slave
pass "kill -9 of the slave: the force fades, the master is ready again when it returns, and engages only after a new press"

start_slave
start_master
wait_for master 'READY -> ENGAGED' 1
for i in $(seq 2000); do printf 'garbage %d \x00\xff<>' "$i" >"/dev/udp/127.0.0.1/$port" || true; done
wait_for slave 'READY -> ENGAGED' 2
end INT master slave
# At the end the master may stop first.
grep 'ENGAGED -> HOLDING' "$dir/slave" | grep -qv 'the other side was stopped' && fail "garbage stopped the slave"
dropped="$(sed -n 's/.*dropped \([0-9]*\),.*/\1/p' "$dir/slave")"
((dropped >= 1000)) || fail "2000 garbage datagrams, $dropped dropped"
pass "garbage from a stranger is dropped and counted ($dropped), motion goes on"

sed 's/^slave {/link { stale_ms: 30 }\nslave {/' "$scene" >"$dir/other.textproto"
start_slave
start_master "$dir/other.textproto"
wait_for master 'no answer from the slave' 1
wait_for slave 'another scene' 1
end INT master slave
stayed_apart || fail "sides with different scenes left DISCONNECTED"
pass "different scenes: the slave says so, the master that nobody answers, and both stay apart"

for signal in INT TERM; do
  relayed=$((port + 1))
  start slave "$scene" --quiet --listen "127.0.0.1:$port"
  start impair --listen "127.0.0.1:$relayed" --to "127.0.0.1:$port" --both 'delay_ms: 20 loss_ratio: 0.01'
  start master "$held" --quiet --slave "127.0.0.1:$relayed"
  wait_for slave 'READY -> ENGAGED' 1
  wait_for master 'READY -> ENGAGED' 1
  kill_hard impair
  wait_for slave 'ENGAGED -> HOLDING' 1
  wait_for slave 'HOLDING -> DISCONNECTED' 1
  wait_for master 'HOLDING -> DISCONNECTED' 1
  before="$(count slave 'READY -> ENGAGED')"
  start impair --listen "127.0.0.1:$relayed" --to "127.0.0.1:$port" --both 'delay_ms: 20 loss_ratio: 0.01'
  wait_for slave 'READY -> ENGAGED' $((before + 1))
  end INT master slave
  end "$signal" impair
  engaged_only_by_a_press
  for way in server client; do
    grep -qE "to $way +came [1-9][0-9]*, sent [1-9][0-9]*, lost [1-9]" "$dir/impair" || fail "the relay's table has no row to the $way"
  done
  pass "through 20 ms and 1 % loss: engages; held while the relay is gone, and it ends in order with its table on SIG$signal"
done

# refused PATTERN ARGUMENT...: the relay says what is wrong with these arguments and does not start.
refused() {
  local pattern="$1" status=0
  shift
  "$bin/farhand-impair" --duration 1 "$@" >"$dir/impair" 2>&1 || status=$?
  ((status == 1 || status == 2)) && grep -qE -- "$pattern" "$dir/impair" || fail "farhand-impair $* gave $status"
}
refused '--listen' --to "127.0.0.1:$port"
refused '--to' --listen "127.0.0.1:$port"
refused "--listen: .*'nowhere'.*10.0.0.2" --listen nowhere --to "127.0.0.1:$port"
refused '--to has port 0' --listen 127.0.0.1:0 --to 127.0.0.1:0
refused '--both .*delay_m.*message Impairment' --listen 127.0.0.1:0 --to "127.0.0.1:$port" --both 'delay_m: 3'
refused 'loss_ratio.*from 0' --listen 127.0.0.1:0 --to "127.0.0.1:$port" --to-slave 'loss_ratio: 2'
refused 'no.textproto' --listen 127.0.0.1:0 --to "127.0.0.1:$port" --scene no.textproto
pass "the relay refuses wrong arguments by their names"
