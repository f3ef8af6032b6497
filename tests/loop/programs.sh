# What the tests that run the programs as processes share; sourced. Wants `bin`, and puts at_NAME before the command of
# farhand-NAME, so that a test may run it elsewhere. What it says is in $dir/NAME.
at_master=() at_slave=() at_impair=() at_observe=()
dir="$(mktemp -d)"
passed=0
trap 'kill -9 $(jobs -p) 2>/dev/null || true; rm -rf "$dir"' EXIT

# SIGKILL is part of the tests: bash need not tell.
set +m
# start NAME ARGUMENT...: farhand-NAME in the background; $NAME becomes its process.
start() { start_as "$1" "$@"; }
# start_as LABEL NAME ARGUMENT...: the same under another label, for a second one.
start_as() {
  local label="$1" name="$2"
  local -n at="at_$name"
  shift 2
  "${at[@]}" "$bin/farhand-$name" "$@" >"$dir/$label" 2>&1 &
  printf -v "$label" %d $!
}

fail() {
  echo "FAILED: $*"
  tail -n 30 "$dir"/{master,second,slave,impair,observe} 2>/dev/null
  exit 1
}
pass() {
  passed=$((passed + 1))
  echo "ok: $*"
}
# count FILE PATTERN: lines of FILE that have it.
count() { grep -c -- "$2" "$dir/$1" || true; }
# wait_for FILE PATTERN COUNT: until FILE has PATTERN at least COUNT times, 20 s at most.
wait_for() {
  for _ in $(seq 1000); do
    (($(count "$1" "$2") >= $3)) && return
    sleep 0.02
  done
  fail "$1 never said '$2' $3 times"
}
# end SIGNAL PROGRAM...: sends it to each and waits for their tables.
end() {
  local signal="$1" name
  shift
  for name in "$@"; do kill "-$signal" "${!name}"; done
  for name in "$@"; do wait "${!name}" || fail "the $name's exit status was $?"; done
}
kill_hard() {
  kill -9 "${!1}"
  wait "${!1}" 2>/dev/null || true
}
mode_lines() { grep -o -- '[A-Z]* -> [A-Z]*' "$dir/$1" || true; }
# Motion begins only from READY, which a held dead-man never reaches.
engaged_only_by_a_press() {
  for name in master slave; do
    mode_lines "$name" | grep -qE '(DISCONNECTED|SYNCING|ALIGNING|HOLDING|FAULT) -> ENGAGED' && fail "the $name engaged without a release"
  done
  return 0
}
# What farhand-flood said it gave and got, in bytes, and the records of data among it.
flood_bytes() { sed -E 's/.* ([0-9]+) bytes; heard [0-9]+, ([0-9]+) bytes, data ([0-9]+)/\1 \2 \3/' "$dir/flood"; }
# Neither side got anywhere but to its end.
stayed_apart() {
  for name in master slave; do
    [[ -z "$(mode_lines "$name" | grep -v -- '-> STOPPED$')" ]] || return 1
  done
}
