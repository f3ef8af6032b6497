#!/usr/bin/env bash
# A flood, processors of their own and full disks: what else runs here would disturb these.
# Usage: load.sh BIN_DIR PORT
set -euo pipefail
cd "$(dirname "$0")/../../.."

bin="$1" port="$2"
source tests/loop/two_processes/both.sh

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
