#!/usr/bin/env bash
# farhand-falcon and farhand-master at an emulated Falcon, as processes through the real libusb: what they print, their exit
# status, and their dialogues to the end, with a hand that is told through a pipe what a user would do.
#
# Each case waits for what the programs say, with generous time-outs; none asserts a time. A machine that stands still for 80 ms
# takes the force away as it would from a real Falcon, so the hand arms it again whenever that is asked for.
# Usage: programs.sh BIN_DIR
set -euo pipefail
cd "$(dirname "$0")/../.."

bin="$1"
source tests/loop/programs.sh

# run EMULATOR'S_FLAGS -- PROGRAM ARGUMENT...: what it says into $dir/falcon; $status is its exit status.
run() {
  local flags=()
  while [[ "$1" != -- ]]; do flags+=("$1") && shift; done
  shift
  status=0
  timeout 120 "$bin/farhand-falcon-emulator" --firmware-loaded "${flags[@]}" -- "$bin/farhand-$1" "${@:2}" \
    >"$dir/falcon" 2>&1 </dev/null || status=$?
}
said() { grep -qaE -- "$1" "$dir/falcon" || { cat "$dir/falcon"; fail "it never said '$1'"; }; }
# ends STATUS PATTERN...
ends() {
  ((status == $1)) || { cat "$dir/falcon"; fail "the exit status was $status"; }
  for pattern in "${@:2}"; do said "$pattern"; done
}

run -- falcon list
ends 0 'serial FH0042  can be opened'
run --serial A7 -- falcon info
ends 0 'firmware +answers' 'homed +axis 1 ' 'exchanges +[1-9][0-9]* per second'
run -- falcon monitor --duration 1
ends 0 'grip \( '
run -- falcon info --serial other
ends 1 'the Falcon does not answer; is one plugged in'
pass "list, info and monitor see it, and not one with another serial number"

status=0
timeout -k 2 120 "$bin/farhand-falcon-emulator" --firmware-loaded -- bash -c '
  "$1" monitor 2>"$2" & until grep -qa "grip (" "$2"; do sleep 0.1; done
  kill -9 $!; "$1" info' - "$bin/farhand-falcon" "$dir/monitor" >"$dir/falcon" 2>&1 </dev/null || status=$?
ends 0 'firmware +answers' 'exchanges +[1-9][0-9]* per second'
pass "the next one has the device that a killed one had"

run --busy -- falcon list
ends 0 'another program has it open; end the other program'
run --busy -- falcon info
ends 1 'another program has it open; end the other program'
run --permission-denied -- falcon list
ends 0 'serial unknown  this user may not open it; install the udev rule'
run --permission-denied -- falcon info
ends 1 'this user may not open it; install the udev rule'
run --no-power -- falcon info
ends 1 'no firmware runs and no image was given.*power supply'
pass "one in other hands, one that this user may not open, and one without power are said to be so, with the remedy"

scene=deploy/scenes/falcon_usb_position.textproto
run -- master --doctor "$scene"
ends 0 '^ok +falcon +serial FH0042 on bus 1 device 2, can be opened' '^ok +firmware +no file named'
run --busy -- master --doctor "$scene"
ends 1 '^problem +falcon +.*another program has it open; end the other program'
run --permission-denied -- master --doctor "$scene"
ends 1 '^problem +falcon +.*this user may not open it; install the udev rule'
sed 's/falcon_usb {/& serial: "A7" firmware_file: "gone.bin"/' "$scene" >"$dir/other.textproto"
run -- master --doctor "$dir/other.textproto"
ends 1 '^problem +falcon +no serial A7, but serial FH0042' '^problem +firmware +.*gone.bin cannot be read'
pass "--doctor tells whether the scene's Falcon is there, free and open to this user, and whether its firmware is"

# ---- with the hand

# begin EMULATOR'S_FLAGS -- PROGRAM ARGUMENT...: in the background, the hand waiting to be told; its keys are file 5.
begin() {
  local flags=()
  while [[ "$1" != -- ]]; do flags+=("$1") && shift; done
  shift
  rm -f "$dir/keys"
  mkfifo "$dir/keys"
  : >"$dir/falcon"
  "$bin/farhand-falcon-emulator" --firmware-loaded --motion none --hand "$dir/hand" "${flags[@]}" -- \
    "$bin/farhand-$1" "${@:2}" <"$dir/keys" >"$dir/falcon" 2>&1 &
  falcon=$!
  exec 5>"$dir/keys"
  for _ in $(seq 600); do [[ -p "$dir/hand" ]] && return; sleep 0.1; done
  fail "the hand's pipe was not made"
}
hand() { echo "$*" >"$dir/hand"; }
running() { kill -0 "$falcon" 2>/dev/null; }
lines() { grep -ca -- "$1" "$dir/falcon" || true; }
# until_said PATTERN COUNT: for two minutes at most, arming the device whenever that is asked for.
until_said() {
  for _ in $(seq 1200); do
    (($(lines "$1") >= $2)) && return
    running || { cat "$dir/falcon"; fail "it ended before it said '$1'"; }
    arm_if_asked
    sleep 0.1
  done
  cat "$dir/falcon"
  fail "it never said '$1' $2 times"
}
# Whenever it says that it is homed it wants the gesture, once the dialogue is that far.
wants_arms=no armed=0 tries=0
arm_if_asked() {
  [[ "$wants_arms" != no ]] || return 0
  local homed
  homed="$(grep -aoE 'homed; for force|armed$' "$dir/falcon" | tail -n 1)"
  if [[ "$homed" == armed ]]; then
    (($(lines 'armed$') > armed)) || return 0
    armed="$(lines 'armed$')" tries=0
    hand release
    if [[ "$wants_arms" == and_lets_go ]]; then hand let go; fi
  elif ((tries++ % 50 == 0)); then
    hand release
    sleep 0.3
    hand press centre forward
  fi
}
finish() {
  for _ in $(seq 1800); do running || break; arm_if_asked; sleep 0.1; done
  status=0
  wait "$falcon" || status=$?
  exec 5>&-
  wants_arms=no armed=0 tries=0
}

begin -- falcon test
until_said 'pull the grip' 1
hand home
for button in centre forward plus minus; do
  until_said "press the $button" 1
  hand release
  hand press "$button"
done
until_said 'now the motors' 1
hand release
wants_arms=and_lets_go
finish
for button in centre forward plus minus; do said "^ok +button $button"; done
# How fast it is asked is the machine's doing; all else must be right.
grep -aE '^FAILED' "$dir/falcon" | grep -qvE 'exchanges per second' && { cat "$dir/falcon"; fail "the test found faults"; }
(($(lines '^ok  *driven to .* mm off') == 7)) || { cat "$dir/falcon"; fail "not all ways were driven"; }
if (($(lines '^FAILED') > 0)); then ends 1 'not all is as it should be'; else ends 0 'all is as it should be'; fi
pass "test asks for the buttons, drives the grip all ways ($(grep -aoE '[0-9.]+ mm off' "$dir/falcon" | sort -n | tail -n 1) at worst), $(grep -aoE '[0-9]+ exchanges per second' "$dir/falcon")"

# A device that is none of the known ones: what calibrate finds is compared with it.
cat >"$dir/truth.textproto" <<'TRUTH'
master {
  falcon { gear_ratio: 7.71 angle_offset_deg: 38.4 }
  falcon_usb { counts_per_newton_meter: 8000 }
  position_control {}
}
TRUTH
calibrates() {
  begin --like "$dir/truth.textproto" -- falcon calibrate --name 'a "quoted" one' -o "$dir/lines"
  until_said 'pull the grip' 1
  hand home
  until_said 'hand: there' 1
  poses=0
  for x in 0 60; do for y in 0 50; do for z in 0 40; do
    poses=$((poses + 1))
    until_said "pose $poses:" 1
    hand move $((x - 30)) $((y - 20)) $((z + 100))
    until_said 'hand: there' $((poses + 1))
    echo "$x $y $z" >&5
  done; done; done
  until_said 'pose 9:' 1
  echo >&5
  until_said 'fits best' 1
  wants_arms=yes
  moves=$((poses + 1)) holds=0
  # weigh GRAMS: with the grip near the middle, let go once the motors hold it.
  weigh() {
    hand weight "$1"
    hand move 0 0 115
    moves=$((moves + 1)) holds=$((holds + 1))
    until_said 'hand: there' "$moves"
    echo "$1" >&5
    until_said 'the motors hold it' "$holds"
    hand let go
  }
  weights=0 missed=0
  for grams in 0 100 200; do
    weights=$((weights + 1))
    until_said "weight $weights:" 1
    weigh "$grams"
    # One that was not held, because the machine stood still, is asked for again.
    until (($(lines "weight $((weights + 1)):") > 0)); do
      until_said "weight $((weights + 1)):\|the grip was not held" $((missed + 1))
      (($(lines 'the grip was not held') > missed)) || continue
      missed=$((missed + 1))
      ((missed < 20)) || { cat "$dir/falcon"; fail "no weight was held in $missed attempts"; }
      weigh "$grams"
    done
  done
  echo >&5
  finish
  ends 0 'TABLE1 fits best' 'pose 8: ' 'counts per N m' 'wrote .*lines'
  { echo 'master {'; cat "$dir/lines"; echo 'position_control {} }'; } >"$dir/calibrated.textproto"
  "$bin/farhand-master" --check "$dir/calibrated.textproto" >"$dir/check" 2>&1 || { cat "$dir/check" "$dir/lines"; fail "its lines are no scene's"; }
  # found NAME TRUTH WITHIN: added to what is told of it.
  results=
  found() {
    local value
    value="$(sed -n "s/^ *$1: //p" "$dir/lines")"
    awk -v a="$value" -v b="$2" -v d="$3" 'BEGIN { exit !(a - b <= d && b - a <= d) }' || { cat "$dir/falcon"; fail "$1 is $2, found $value"; }
    results+="$1 $value of $2, "
  }
  found gear_ratio 7.71 0.02
  found angle_offset_deg 38.4 0.2
  found counts_per_newton_meter 8000 160
  pass "calibrate finds $results$(grep -aoE 'the grip itself [0-9]+ g' "$dir/falcon") of 120, and its lines are a scene's"
}
# The motors hold a weight by a control that is made for a thousand exchanges a second.
rate="$(grep -aoE '[0-9]+ exchanges per second' "$dir/falcon" | grep -oE '^[0-9]+')"
if ((rate < 800)); then
  echo "skipped: calibrate at the emulated Falcon: this machine asks it $rate times a second, it takes 800 to hold a weight"
else
  calibrates
fi

# ---- a teleoperation

port=$((20000 + RANDOM % 20000))
{ echo "link { slave_address: \"127.0.0.1:$port\" }"
  sed 's/^master {/& realtime { allow_degraded: true }/' deploy/scenes/falcon_usb.textproto; } >"$dir/scene.textproto"

# told PATTERN: waits for it; false if that takes a minute, or the master is in FAULT or ends.
told() {
  for _ in $(seq 600); do
    grep -qa 'FAULT' "$dir/falcon" && return 1
    (($(lines "$1") > 0)) && return 0
    running || return 1
    sleep 0.1
  done
  return 1
}
# Homes, arms, engages and moves 20 mm; true if it did so from its begin to its end in order.
teleoperates() {
  local done=no
  start slave "$dir/scene.textproto" --quiet
  begin -- master "$dir/scene.textproto" --quiet
  if told 'device: pull the grip' && hand home && told 'hand: there' && told 'device: homed' &&
    hand press centre forward && told 'device: armed' && hand release && told 'hand: release' && sleep 0.5 &&
    hand press centre && told '-> ENGAGED' && hand move 0 0 140 && told 'hand: move' && sleep 3 && ! grep -qa FAULT "$dir/falcon"; then
    done=yes
  fi
  kill -TERM "$falcon"
  finish
  end INT slave
  [[ "$done" == yes ]] && ((status == 0)) && grep -qa -- '-> STOPPED' "$dir/falcon" && ! grep -qa FAULT "$dir/falcon"
}
# One that stands still for 80 ms is out of luck, not wrong.
for ((attempt = 1; ; attempt++)); do
  teleoperates && break
  ((attempt < 8)) || { cat "$dir/falcon"; fail "not one of $attempt teleoperations went through"; }
done
grep -qaE 'ENGAGED [1-9][0-9]{2,}' "$dir/falcon" || fail "the master's table has no motion"
pass "a teleoperation by the emulated Falcon engages, moves and ends in order (attempt $attempt)"

echo "$passed passed, 0 failed"
