# What the parts of two_processes.sh share; sourced. Wants `bin` and `port`, the first of three.
source tests/loop/programs.sh
scene=tests/loop/presses.textproto
start_slave() { start slave "${1:-$scene}" --quiet --listen "127.0.0.1:$port"; }
start_master() { start master "${1:-$scene}" --quiet --slave "127.0.0.1:$port"; }
# One that must not start; if it does, it ends well.
start_refused() { start master "$1" --quiet --duration 5 --slave "127.0.0.1:$port"; }

# keyed NAME: the scene with $dir/NAME.key.
keyed() {
  { echo "link { key_file: \"$1.key\" }"; cat "$scene"; } >"$dir/$1.textproto"
  echo "$dir/$1.textproto"
}
"$bin/farhand-keygen" "$dir/one.key" >/dev/null
"$bin/farhand-keygen" "$dir/two.key" >/dev/null
one="$(keyed one)"

# certified SIDE DIRECTORY: the scene with that side's certificate of $dir/DIRECTORY.
certified() {
  { echo "link { certificates { authority_file: \"$2/authority.pem\" certificate_file: \"$2/$1.pem\" private_key_file: \"$2/$1_key.pem\" } }"
    cat "$scene"; } >"$dir/$1_$2.textproto"
  echo "$dir/$1_$2.textproto"
}
"$bin/farhand-keygen" --certificates "$dir/ours" >/dev/null
"$bin/farhand-keygen" --certificates "$dir/theirs" >/dev/null

# doctor STATUS PATTERN SIDE ARGUMENT...: its exit status, and what it says.
doctor() {
  local status=0 expected="$1" pattern="$2" side="$3"
  shift 3
  "$bin/farhand-$side" --doctor "$@" >"$dir/$side.doctor" 2>&1 || status=$?
  ((status == expected)) && grep -qE -- "$pattern" "$dir/$side.doctor" || { cat "$dir/$side.doctor"; fail "farhand-$side --doctor $* gave $status"; }
}
