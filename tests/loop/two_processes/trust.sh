#!/usr/bin/env bash
# With keys and with certificates: who is let in, who is refused and told why, and what --doctor finds.
# Usage: trust.sh BIN_DIR PORT
set -euo pipefail
cd "$(dirname "$0")/../../.."

bin="$1" port="$2"
source tests/loop/two_processes/both.sh

"$bin/farhand-keygen" "$dir/one.key" >/dev/null 2>&1 && fail "farhand-keygen overwrote a key"
"$bin/farhand-keygen" --certificates "$dir/ours" >/dev/null 2>&1 && fail "farhand-keygen overwrote certificates"

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
