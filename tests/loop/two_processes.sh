#!/usr/bin/env bash
# farhand-slave and farhand-master as two processes over UDP on this machine:
#
#   master (simulated hand) ---- 127.0.0.1 ---- slave (simulated arm)
#   master ---- 127.0.0.1 ---- relay ---- 127.0.0.1 ---- slave
#
# Each case waits for what the programs say, with generous time-outs; none asserts a time. Usage: two_processes.sh BIN_DIR
set -euo pipefail
cd "$(dirname "$0")/../.."

bin="$1"
source tests/loop/programs.sh
scene=tests/loop/presses.textproto
port=$((20000 + RANDOM % 20000))
start_slave() { start slave "${1:-$scene}" --quiet --listen "127.0.0.1:$port"; }
start_master() { start master "${1:-$scene}" --quiet --slave "127.0.0.1:$port"; }
# One that must not start; if it does, it ends well.
start_refused() { start master "$1" --quiet --duration 5 --slave "127.0.0.1:$port"; }

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

start_slave
start_master
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
start_master
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
  start master "$scene" --quiet --slave "127.0.0.1:$relayed"
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

# keyed NAME: the scene with $dir/NAME.key.
keyed() {
  { echo "link { key_file: \"$1.key\" }"; cat "$scene"; } >"$dir/$1.textproto"
  echo "$dir/$1.textproto"
}
"$bin/farhand-keygen" "$dir/one.key" >/dev/null
"$bin/farhand-keygen" "$dir/two.key" >/dev/null
"$bin/farhand-keygen" "$dir/one.key" >/dev/null 2>&1 && fail "farhand-keygen overwrote a key"
one="$(keyed one)"

# engages_again SLAVE'S_SCENE MASTER'S_SCENE: engaged, and again after kill -9 of either side.
engages_again() {
  local before
  start_slave "$1"
  start_master "$2"
  wait_for slave 'READY -> ENGAGED' 1
  wait_for master 'READY -> ENGAGED' 1
  before="$(count slave 'ENGAGED$')"
  kill_hard master
  start_master "$2"
  wait_for slave 'READY -> ENGAGED' $((before + 1))
  before="$(count master 'ENGAGED$')"
  kill_hard slave
  start_slave "$1"
  wait_for master 'READY -> ENGAGED' $((before + 1))
  wait_for slave 'READY -> ENGAGED' 1
  engaged_only_by_a_press
  end INT master slave
}
engages_again "$one" "$one"
for side in master slave; do
  grep -q "key $(sed -n 's/^# Farhand key \([0-9a-f]*\).*/\1/p' "$dir/one.key")" "$dir/$side" || fail "the $side did not name its key"
done
pass "with one key: engages, and again after kill -9 of either side"

# certified SIDE DIRECTORY: the scene with that side's certificate of $dir/DIRECTORY.
certified() {
  { echo "link { certificates { authority_file: \"$2/authority.pem\" certificate_file: \"$2/$1.pem\" private_key_file: \"$2/$1_key.pem\" } }"
    cat "$scene"; } >"$dir/$1_$2.textproto"
  echo "$dir/$1_$2.textproto"
}
"$bin/farhand-keygen" --certificates "$dir/ours" >/dev/null
"$bin/farhand-keygen" --certificates "$dir/theirs" >/dev/null
"$bin/farhand-keygen" --certificates "$dir/ours" >/dev/null 2>&1 && fail "farhand-keygen overwrote certificates"

engages_again "$(certified slave ours)" "$(certified master ours)"
for side in master slave; do
  grep -q 'certificate [0-9a-f]\{8\} of authority [0-9a-f]\{8\}' "$dir/$side" || fail "the $side did not name its certificate"
  other="$([[ "$side" == master ]] && echo slave || echo master)"
  grep -q "connected with .* of certificate $(sed -n 's/.*certificate \([0-9a-f]\{8\}\) of authority.*/\1/p' "$dir/$other" | head -n 1)" "$dir/$side" || fail "the $side did not name the other's certificate"
done
pass "with certificates of one authority: engages, and again after kill -9 of either side"

start_slave "$(certified slave ours)"
start_master "$(certified master theirs)"
wait_for master 'the slave has a certificate of another authority' 1
wait_for slave 'a master that would connect says that it has a certificate of another authority' 1
wait_for master 'no answer from the slave' 1
end INT master slave
stayed_apart || fail "sides with certificates of different authorities left DISCONNECTED"
start_slave "$(certified slave ours)"
start_master "$one"
wait_for master 'the slave says that it proves itself otherwise' 1
wait_for slave 'a master that would connect proves itself otherwise' 1
end INT master slave
stayed_apart || fail "a key connected with a certificate"
pass "certificates of another authority, or a key on one side: both say so and stay apart"

start_slave "$(certified slave ours)"
start_master "$(certified observer ours)"
wait_for slave 'the certificate of a master that would connect is not a master' 1
wait_for master 'no answer from the slave' 1
end INT master slave
stayed_apart || fail "an observer's certificate leads the robot"
pass "an observer's certificate leads nothing: the slave says so, and both stay apart"

# Its own certificate in the other's place, as if stolen, and files that do not fit.
start_refused "$(certified slave ours)"
wait "$master" && fail "a master took a slave's certificate"
grep -q 'slave.pem is not for a master' "$dir/master" || fail "the master does not say whose certificate it is"
sed 's/master_key/slave_key/' "$(certified master ours)" >"$dir/unfit.textproto"
start_refused "$dir/unfit.textproto"
wait "$master" && fail "a private key that does not fit was taken"
grep -q 'does not fit the certificate' "$dir/master" || fail "the master does not say which does not fit"
chmod 644 "$dir/theirs/master_key.pem"
start_refused "$(certified master theirs)"
wait "$master" && fail "a private key that all may read was taken"
grep -q 'chmod 600' "$dir/master" || fail "the master does not say what to do about the open private key"
pass "the slave's certificate, a private key that does not fit and one that is open are refused, with the remedy"

# Two masters and one slave, which one of them leads.
for of in "$scene" "$one"; do
  start_slave "$of"
  start_master "$of"
  wait_for slave 'READY -> ENGAGED' 1
  start_as second master "$of" --quiet --slave "127.0.0.1:$port"
  wait_for second 'led by another master.*--take-over' 1
  before="$(count slave 'READY -> ENGAGED')"
  wait_for slave 'READY -> ENGAGED' $((before + 1))
  mode_lines slave | grep -q -- '-> DISCONNECTED' && fail "the second master disturbed the first"
  [[ -z "$(mode_lines second)" ]] || fail "the second master was let in"
  kill_hard master
  wait_for second 'READY -> ENGAGED' 1
  start master "$of" --quiet --slave "127.0.0.1:$port" --take-over
  wait_for second 'another master took over' 1
  wait "$second" || fail "the former master's exit status was $?"
  before="$(count slave 'READY -> ENGAGED')"
  wait_for slave 'READY -> ENGAGED' $((before + 1))
  wait_for master 'READY -> ENGAGED' 1
  engaged_only_by_a_press
  end INT master slave
  pass "two masters ($(basename "$of")): the second is refused and told, waits, leads when the first is gone, and ends when it is taken over from"
done

# seen_by SCENE: the same with an address at which it may be looked at.
seen_by() {
  sed "s/^link {/link { observer_address: \"127.0.0.1:$((port + 2))\"/" "$1" >"$dir/seen_$(basename "$1")"
  grep -q '^link' "$1" || echo "link { observer_address: \"127.0.0.1:$((port + 2))\" }" >>"$dir/seen_$(basename "$1")"
  echo "$dir/seen_$(basename "$1")"
}
for of in "$scene" "$one"; do
  seen="$(seen_by "$of")"
  start_slave "$seen"
  start observe "$seen"
  start_as watcher observe "$seen"
  start_master "$seen"
  for who in observe watcher; do
    wait_for "$who" ': READY' 1
    wait_for "$who" ': ENGAGED' 2
    wait_for "$who" 'ENGAGED tool' 1
  done
  end INT observe watcher
  before="$(count slave 'READY -> ENGAGED')"
  wait_for slave 'READY -> ENGAGED' $((before + 1))
  end INT master slave
  pass "two look on ($(basename "$of")): they see the states and the tool, and motion goes on"
done
start_slave "$(seen_by "$(certified slave ours)")"
start observe "$(seen_by "$(certified observer ours)")"
wait_for observe 'DISCONNECTED' 1
end INT observe slave
pass "an observer with a certificate looks on"
start_slave "$(seen_by "$one")"
start observe "$(seen_by "$scene")"
wait_for observe 'no answer from the slave' 1
end INT observe slave
pass "who has no key sees nothing"

start_slave "$one"
start_master "$one"
wait_for slave 'READY -> ENGAGED' 1
"$bin/farhand-flood" --to "127.0.0.1:$port" --duration 2 >"$dir/flood" || fail "$(cat "$dir/flood")"
before="$(count slave 'READY -> ENGAGED')"
wait_for slave 'READY -> ENGAGED' $((before + 1))
engaged_only_by_a_press
end INT master slave
read -r said heard data < <(flood_bytes)
((heard > 0 && heard <= said && data == 0)) || fail "a stranger got $heard bytes for $said, $data records of data"
pass "a flood of 20 000 datagrams a second: a stranger gets fewer bytes than it gives ($heard for $said), no record of data, and motion goes on"

start_slave "$one"
start_master "$(keyed two)"
wait_for master 'the slave says that it has another key than this side' 1
wait_for slave 'a master that would connect has another key' 1
wait_for master 'no answer from the slave' 1
end INT master slave
stayed_apart || fail "sides with different keys left DISCONNECTED"
grep -q 'farhand-keygen' "$dir/slave" || fail "the slave names no remedy"
pass "different keys: both sides say so and stay apart"

start_slave "$one"
start_master
wait_for master 'no answer from the slave' 1
end INT master slave
stayed_apart || fail "a master without the key was heard"
pass "a master without a key is not heard by a slave that has one"

chmod 644 "$dir/two.key"
start_refused "$(keyed two)"
wait "$master" && fail "a key that all may read was taken"
grep -q 'chmod 600' "$dir/master" || fail "the master does not say what to do about the open key"
"$bin/farhand-slave" "$scene" --quiet --listen "0.0.0.0:$port" >"$dir/slave" 2>&1 && fail "a plain link beyond this machine was taken"
grep -q 'farhand-keygen' "$dir/slave" || fail "the slave does not say how to leave this machine"
pass "an open key file and a plain link to the world are refused, with the remedy"

# doctor STATUS PATTERN SIDE ARGUMENT...: its exit status, and what it says.
doctor() {
  local status=0 expected="$1" pattern="$2" side="$3"
  shift 3
  "$bin/farhand-$side" --doctor "$@" >"$dir/$side.doctor" 2>&1 || status=$?
  ((status == expected)) && grep -qE -- "$pattern" "$dir/$side.doctor" || { cat "$dir/$side.doctor"; fail "farhand-$side --doctor $* gave $status"; }
}
start_slave "$one"
wait_for slave 'listening on' 1
doctor 1 'problem +address .*another program has this port' slave "$one" --listen "127.0.0.1:$port"
doctor 0 '^0 problems' master "$one" --slave "127.0.0.1:$port"
grep -q '^problem' "$dir/master.doctor" && fail "the doctor counted no problem and named one"
grep -qE '^ok +key +[0-9a-f]{8} in ' "$dir/master.doctor" || fail "the doctor does not name the key"
end INT slave
grep -q 'datagrams received 0, dropped 0' "$dir/slave" || fail "the doctor sent the slave something"
doctor 0 '^ok +address +127.0.0.1:[0-9]+ can be bound$' slave "$one" --listen "127.0.0.1:$port"
doctor 1 'problem +key .*gone.key.*farhand-keygen' master "$(keyed gone)"
doctor 0 '^ok +certificate +[0-9a-f]{8} of authority .*valid until' master "$(certified master ours)"
doctor 1 'problem +certificate .*is not for a slave' slave "$(certified master ours)"
doctor 1 'problem +scene .*no.textproto:1:1' master no.textproto
doctor 1 'problem +address .*has no slave' slave deploy/scenes/falcon_f1.textproto
doctor 2 'scene is required' slave
doctor 2 '--docter' master "$scene" --docter
pass "--doctor finds nothing wrong, a port in use, a key and a scene that are missing, and sends nothing"

line="/dev/no_such_line"
printf 'master { falcon {} sim_hand {} ahrs { serial { path: "%s" } } }\nslave { sim_arm {} workspace {} joint_pid {} }\n' "$line" >"$dir/line.textproto"
doctor 1 "problem +ahrs +$line cannot be read .*plug the AHRS in" master "$dir/line.textproto"
"$bin/farhand-master" "$dir/line.textproto" --quiet --duration 1 >"$dir/master" 2>&1 && fail "the master started without its AHRS"
grep -q "serial: $line cannot be read .*plug the AHRS in" "$dir/master" || fail "a missing AHRS is not told"
sed 's/press { button: DEAD_MAN at_s: 2 }/press { button: DEAD_MAN at_s: 2 lasting_s: 3 } press { button: DEAD_MAN at_s: 7 lasting_s: 3 } press { button: DEAD_MAN at_s: 12 }/' \
  deploy/scenes/falcon_ahrs.textproto >"$dir/ahrs.textproto"
start_slave "$dir/ahrs.textproto"
start_master "$dir/ahrs.textproto"
wait_for master 'it knows how the grip is turned' 1
wait_for slave 'READY -> ENGAGED' 1
end INT master slave
engaged_only_by_a_press
pass "an AHRS on the grip is waited for before the first press; one that is not there is told by --doctor and the start"

for side in master slave; do
  sed "s/^$side {/& realtime { cpu: 1023 }/" "$scene" >"$dir/pinned.textproto"
  doctor 1 'problem +processors +there is no processor 1023: name one from 0' "$side" "$dir/pinned.textproto"
  "$bin/farhand-$side" "$dir/pinned.textproto" --quiet --duration 1 >"$dir/$side" 2>&1 && fail "the $side took a processor that is not there"
  grep -q '^farhand-.*: there is no processor 1023: name one from 0' "$dir/$side" || fail "the $side does not say which processor"
done
sed "s/^master {/& realtime { cpu: 0 spin_us: 100 }/; s/^slave {/& realtime { cpu: $(($(nproc) - 1)) spin_us: 100 }/" "$scene" >"$dir/pinned.textproto"
start_slave "$dir/pinned.textproto"
start_master "$dir/pinned.textproto"
wait_for slave 'READY -> ENGAGED' 1
for side in master slave; do
  [[ "$side" == master ]] && cpu=0 || cpu=$(($(nproc) - 1))
  (($(grep -h Cpus_allowed_list "/proc/${!side}/status" | grep -cw "$cpu") == 1)) || fail "the ${side}'s loop is not on processor $cpu"
  others="$(grep -h Cpus_allowed_list /proc/"${!side}"/task/*/status | grep -cvxE "Cpus_allowed_list:\s$cpu" || true)"
  ((others > 0 || $(nproc) == 1)) || fail "the ${side}'s other threads share its processor"
done
end INT master slave
pass "a processor that is not there is refused; on their own, spinning, both engage with the other threads elsewhere"

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
