#!/usr/bin/env bash
# farhand-master and farhand-slave on two hosts, which are network namespaces of this machine:
#
#     host of the master          host of the relay             host of the slave
#     farhand-master              farhand-impair                farhand-slave
#     10.77.1.2  m-r ----------- r-m 10.77.1.1
#                                10.77.2.1 r-s --------------- s-r  10.77.2.2
#     10.77.3.2  m-s -------------------------------------------- s-m  10.77.3.1
#
# A case begins while both are engaged, does its harm, and must end with both ready again by themselves and engaged by a new
# press alone. Time-outs are generous, times are told and not judged. Nothing of this is left when the script ends.
# Usage: two_hosts.sh BIN_DIR [REPEAT [AT_ONCE]]: AT_ONCE side by side, each with networks of its own, each REPEAT times over.
set -euo pipefail
cd "$(dirname "$0")/../.."

# Of lines "MILLISECONDS CASE".
tell_times() {
  echo 'ready again after, in ms, with the wait for the operator to let go:'
  sort -k2 -k1n | awk '
    function tell() { printf "  %-55s median %5d  worst %5d  of %d\n", name, all[int((n + 1) / 2)], all[n], n }
    { now = $1; sub(/^[0-9]+ /, "") }
    $0 != name { if (n) tell(); name = $0; n = 0 }
    { all[++n] = now }
    END { tell() }'
}
if ((${3:-1} > 1)); then
  logs="$(mktemp -d)" runs=() failed=0
  trap 'kill $(jobs -p) 2>/dev/null || true; wait; rm -rf "$logs"' EXIT
  for ((i = 0; i < $3; ++i)); do
    "$0" "$1" "${2:-1}" >"$logs/$i" 2>&1 &
    runs+=($!)
  done
  for ((i = 0; i < $3; ++i)); do
    wait "${runs[i]}" || { cat "$logs/$i" && failed=1; }
  done
  ((failed == 0)) || exit 1
  if (($(grep -l '^skipped: ' "$logs"/* | wc -l) == $3)); then exec cat "$logs/0"; fi
  sed -n 's/^ok: \(.*\) (ready after \([0-9]*\) ms)$/\2 \1/p' "$logs"/* | tell_times
  passed="$(cat "$logs"/* | grep -c '^ok: ')" each="$(grep -c '^ok: ' "$logs/0")"
  echo "$passed passed, 0 failed"
  ((passed > 0 && passed == $3 * each)) || { echo "FAILED: not every run had its $each cases"; exit 1; }
  exit 0
fi

skip() {
  echo "skipped: two_hosts.sh: $*"
  exit 0
}
# In a network and a /run of its own; who may not do that as himself tries as the root of a user namespace.
if [[ -z "${FARHAND_OWN_NETWORK:-}" ]]; then
  command -v ip >/dev/null || skip "ip is not installed (package iproute2)"
  own=(unshare --net --mount)
  ((EUID == 0)) || own+=(--user --map-root-user)
  # shellcheck disable=SC2016
  "${own[@]}" bash -c 'mount -t tmpfs none /run && ip netns add a && ip link add name b type veth peer name c' 2>/dev/null ||
    skip "network namespaces are not permitted here"
  FARHAND_OWN_NETWORK=1 exec "${own[@]}" "$0" "$@"
fi
mount -t tmpfs none /run

bin="$1" repeat="${2:-1}"
source tests/loop/programs.sh
scene="$dir/scene.textproto"
{ cat tests/loop/presses.textproto && echo 'link { insecure: true }'; } >"$scene"

# on HOST COMMAND...
on() { ip netns exec "$@"; }
# cable HOST DEVICE ADDRESS HOST DEVICE ADDRESS
cable() {
  ip link add name "$2" type veth peer name "$5"
  for _ in 1 2; do
    ip link set "$2" netns "$1"
    on "$1" ip addr add "$3/24" dev "$2"
    on "$1" ip link set "$2" up
    shift 3
  done
}
for name in master slave impair; do
  ip netns add "$name"
  declare -a "at_$name=(ip netns exec $name)"
done
cable master m-r 10.77.1.2 impair r-m 10.77.1.1
cable impair r-s 10.77.2.1 slave s-r 10.77.2.2
cable master m-s 10.77.3.2 slave s-m 10.77.3.1

readonly mild='delay_ms: 5 jitter_ms: 1 loss_ratio: 0.01' bad='delay_ms: 20 loss_ratio: 0.01'
readonly stopped='-> \(HOLDING\|DISCONNECTED\)' gone='-> DISCONNECTED'

start_one() {
  case "$1" in
    slave) start slave "$scene" --quiet --listen 0.0.0.0:47810 ;;
    impair) start impair --listen 10.77.1.1:47811 --to 10.77.2.2:47810 --both "$network" ;;
    master) start master "$scene" --quiet --listen 0.0.0.0:0 --slave "$address" ;;
  esac
}
# engage RELAY'S IMPAIRMENT, or engage directly: fresh programs, until both are engaged.
engage() {
  local name
  network="$1" address=10.77.1.1:47811 programs=(slave impair master)
  [[ "$1" == directly ]] && address=10.77.3.1:47810 programs=(slave master)
  for name in "${programs[@]}"; do start_one "$name"; done
  for name in slave master; do
    wait_for "$name" 'READY -> ENGAGED' 1
    halts[$name]="$(count "$name" "$stopped")" losses[$name]="$(count "$name" "$gone")"
  done
}
# Since the harm began, NAME has left ENGAGED or READY; NAME has given its partner up.
halts() { wait_for "$1" "$stopped" $((halts[$1] + 1)); }
loses() { wait_for "$1" "$gone" $((losses[$1] + 1)); }

# look NAME: how often it became READY and ENGAGED, and whether it is READY now. Without a process of its own, for which a busy
# machine takes a while in which the operator goes on.
look() {
  local line
  readies=0 engagements=0 is_ready=0
  mapfile -t lines <"$dir/$1"
  for line in "${lines[@]}"; do
    [[ "$line" == *' -> '* ]] && is_ready=0
    [[ "$line" == *' -> READY'* ]] && is_ready=1 readies=$((readies + 1))
    [[ "$line" == *'READY -> ENGAGED'* ]] && engagements=$((engagements + 1))
  done
  return 0
}
# reaches NAME READIES ENGAGEMENTS: until it has been each so often, 20 s at most.
exec {nothing}<> <(:)
reaches() {
  for _ in $(seq 2000); do
    look "$1"
    ((readies >= $2 && engagements >= $3)) && return
    read -rt 0.01 -u "$nothing" || true
  done
  fail "$1 was never READY $2 times and ENGAGED $3 times"
}
# recovers COMMAND...: it ends the harm; both are ready, again if they were not, and engaged once more.
recovers() {
  local name begin
  local -A ready engaged
  for name in slave master; do
    look "$name"
    ready[$name]=$((readies + 1 - is_ready)) engaged[$name]=$engagements
  done
  if [[ "$1" == start_one ]]; then
    ready[$2]=1 engaged[$2]=0
    : >"$dir/$2"
  fi
  "$@"
  begin="${EPOCHREALTIME/[.,]/}"
  for name in slave master; do reaches "$name" "${ready[$name]}" 0; done
  took=$(((${EPOCHREALTIME/[.,]/} - begin) / 1000))
  for name in slave master; do reaches "$name" 0 $((engaged[$name] + 1)); done
}
finish() {
  engaged_only_by_a_press
  end INT "${programs[@]}"
  echo "$took $1" >>"$dir/times"
  pass "$1 (ready after $took ms)"
}
other() { [[ "$1" == slave ]] && echo master || echo slave; }

undisturbed() {
  engage "$1"
  recovers true
  finish "$2"
}
killed() {
  engage "$mild"
  kill_hard "$1"
  halts "$(other "$1")"
  loses "$(other "$1")"
  recovers start_one "$1"
  finish "kill -9 of $1"
}
paused() {
  engage "$mild"
  kill -STOP "${!1}"
  sleep "$2"
  recovers kill -CONT "${!1}"
  [[ "$2" == 0.005 ]] || halts "$(other "$1")"
  [[ "$2" == 5 ]] && loses "$(other "$1")"
  finish "$1 stands still for $2 s"
}
unplugged() {
  engage "$mild"
  on "$1" ip link set "$2" down
  sleep 1.5
  recovers on "$1" ip link set "$2" up
  local name
  for name in slave master; do halts "$name" && loses "$name"; done
  finish "cable out for 1.5 s at $1's $2"
}
# move DEVICE FROM TO: the master's host gets another address.
move() {
  on master ip addr del "$2/24" dev "$1"
  on master ip addr add "$3/24" dev "$1"
}
moved() {
  engage "$1"
  recovers move "$2" "$3" "$4"
  finish "another address of the master's host on $2"
  move "$2" "$4" "$3"
}

declare -A halts losses
for _ in $(seq "$repeat"); do
  undisturbed '' 'a good network'
  undisturbed "$bad" '20 ms and 1 % loss'
  for program in master slave impair; do killed "$program"; done
  for program in master slave; do
    for seconds in 0.005 0.1 5; do paused "$program" "$seconds"; done
  done
  unplugged impair r-m
  unplugged master m-r
  unplugged slave s-r
  moved "$mild" m-r 10.77.1.2 10.77.1.4
  moved directly m-s 10.77.3.2 10.77.3.4
done

tell_times <"$dir/times"
echo "$passed passed, 0 failed"
