#!/usr/bin/env bash
# Two masters of which one leads, and those who look on.
# Usage: several.sh BIN_DIR PORT
set -euo pipefail
cd "$(dirname "$0")/../../.."

bin="$1" port="$2"
source tests/loop/two_processes/both.sh

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
