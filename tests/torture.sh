#!/usr/bin/env bash
# Kills training runs at random moments, on a disk that fills and empties, and lets device allocations fail:
#   torture.sh COMMAND [KILLS [SEED]]
# Every resumed run must end with the checkpoint of an undisturbed one, byte for byte. Prints one line a kind.
set -u
command=$(realpath "$1")
kills=${2:-200}
RANDOM=${3:-$$}
work=$(mktemp -d "${TMPDIR:-/tmp}/motiongan-torture-XXXXXX")
disk=$work/disk
log=$work/last.log
failures=0

cleanup() {
  kill $(jobs -p) 2>/dev/null
  mountpoint -q "$disk" 2>/dev/null && umount -l "$disk"
  rm -rf "$work"
}
trap cleanup EXIT
trap 'exit 130' INT TERM

# A small file system of its own, if this user may mount one.
mkdir -p "$disk"
if mount -t tmpfs -o size=1g tmpfs "$disk" 2>/dev/null; then mounted=1; else
  mounted=0
  echo "torture: no permission to mount a small file system: the disk does not fill"
fi

# Motion as text of exponential maps for the prediction models: two actions of two subjects and a test subject.
for name in S1/walking_1 S1/walking_2 S1/eating_1 S1/eating_2 S5/walking_1 S5/walking_2 S5/eating_1 S5/eating_2; do
  mkdir -p "$work/maps/${name%/*}"
  awk -v phase=${#name} 'BEGIN { for (f = 0; f < 400; f++) for (c = 0; c < 15; c++)
    printf "%.7g%s", 0.4 * sin(0.03 * f * (1 + 0.2 * c) + phase + c), c < 14 ? "," : "\n" }' >"$work/maps/$name.txt"
done

# Five trainers. Each saves after every iteration. FOLDER is the run's; the checkpoint lies below it.
run() { # run KIND FOLDER [resume]
  local kind=$1 folder=$2 save="--save-every 1e-9 --log-every 3"
  local dvgan="--procedural 6 --frames 16 --hidden 16 --batch 4 --critic-steps 2"
  case $kind in
    dvgan) set -- train dvgan ${3:+--resume} $dvgan --save "$folder" --iterations 300 $save ;;
    ranker) set -- train ranker ${3:+--resume} --procedural 6 --frames 16 --hidden 16 --batch 4 --save "$folder" --iterations 300 $save ;;
    attention) set -- train attention ${3:+--resume} --procedural 6 --frames 8 --hidden 16 --batch 4 --critic-steps 1 --save "$folder" --iterations 200 $save ;;
    baseline) set -- train attention ${3:+--resume} --model lstm --procedural 6 --frames 8 --hidden 16 --batch 4 --save "$folder" --iterations 200 $save ;;
    prediction) set -- evaluate completion "$work/maps" --models seq2seq --hidden 8 --batch 2 --save "$folder" --iterations 200 $save ;;
  esac
  exec "$command" "$@" >"$log" 2>&1
}
checkpoint_of() {
  case $1 in
    prediction) echo "$2/seq2seq/checkpoint.safetensors" ;;
    *) echo "$2/checkpoint.safetensors" ;;
  esac
}
fail() {
  failures=$((failures + 1))
  echo "FAILED: $*"
  sed 's/^/    /' "$log" | tail -n 5
}

filler() { # fills and empties the disk
  while :; do
    head -c 2G /dev/zero >"$disk/filler" 2>/dev/null
    sleep 0.$((RANDOM % 10))
    rm -f "$disk/filler"
    sleep 0.$((RANDOM % 10 + 3))
  done
}

torture_kind() {
  local kind=$1 wanted=$2 reference=$work/reference folder=$disk/run start_ms filler_pid=
  rm -rf "$reference" "$folder"
  start_ms=$(date +%s%3N)
  (run "$kind" "$reference") || { fail "$kind: the undisturbed run"; return; }
  local whole=$(($(date +%s%3N) - start_ms)) killed=0 errors=0 tries=0 status
  (run "$kind" "$reference-again") || { fail "$kind: the second undisturbed run"; return; }
  cmp -s "$(checkpoint_of "$kind" "$reference")" "$(checkpoint_of "$kind" "$reference-again")" ||
    fail "$kind: two undisturbed runs differ"
  rm -rf "$reference-again"
  if [ $mounted = 1 ]; then
    mount -o remount,size=$(($(du -sk "$reference" | cut -f1) * 3 + 256))k "$disk"
    filler & filler_pid=$!
  fi
  while [ $killed -lt "$wanted" ] && [ $tries -lt $((wanted * 3)) ]; do
    tries=$((tries + 1))
    local resume=
    [ -e "$(checkpoint_of "$kind" "$folder")" ] && resume=1
    (run "$kind" "$folder" $resume) & local pid=$!
    local wait=$((RANDOM % (whole > 2500 ? 2500 : whole) + 100))
    sleep "$((wait / 1000)).$(printf %03d $((wait % 1000)))"
    if kill -9 $pid 2>/dev/null; then killed=$((killed + 1)); fi
    wait $pid 2>/dev/null
    status=$?
    case $status in
      137) ;;
      0) rm -rf "$folder" ;; # finished before it was killed: from the start again
      1) errors=$((errors + 1)); grep -q '^motiongan: ' "$log" || fail "$kind: status 1 without a message" ;;
      *) fail "$kind: status $status" ;;
    esac
  done
  if [ -n "$filler_pid" ]; then
    kill $filler_pid 2>/dev/null
    wait $filler_pid 2>/dev/null
    rm -f "$disk/filler"
    mount -o remount,size=1g "$disk"
  fi
  local resume=
  [ -e "$(checkpoint_of "$kind" "$folder")" ] && resume=1
  (run "$kind" "$folder" $resume) || fail "$kind: the run could not be resumed"
  cmp -s "$(checkpoint_of "$kind" "$reference")" "$(checkpoint_of "$kind" "$folder")" ||
    fail "$kind: the resumed run differs from the undisturbed one"
  find "$folder" -name '*.tmp' | grep . && fail "$kind: files were left over"
  echo "torture: $kind: $killed kills in $tries starts, $errors ended by the full disk; resumed to the same bits"
}

# The n-th device allocation fails, for n up to those of an iteration.
torture_allocations() {
  local n=0 refused=0 status folder=$work/allocations
  (run dvgan "$folder" & pid=$!; sleep 2; kill -TERM $pid; wait $pid)
  [ -e "$folder/checkpoint.safetensors" ] || { fail "allocations: no run to continue"; return; }
  while [ $n -lt 2000 ]; do
    n=$((n + (n < 100 ? 1 : 7)))
    MOTIONGAN_FAIL_ALLOCATION=$n timeout 60 "$command" train dvgan --resume --save "$folder" --iterations 100000 --minutes 0.001 >"$log" 2>&1
    status=$?
    [ $status = 0 ] && break
    if [ $status != 1 ] || ! grep -q '^motiongan: ' "$log"; then fail "allocation $n: status $status"; fi
    refused=$((refused + 1))
  done
  echo "torture: allocations: $refused failed, up to the ${n}th of a run, each with an error; the run goes on"
}

for kind in dvgan ranker attention baseline prediction; do torture_kind $kind $((kills / 5)); done
torture_allocations
[ $failures = 0 ] && echo "torture: passed" || echo "torture: $failures failures"
exit $((failures > 0))
