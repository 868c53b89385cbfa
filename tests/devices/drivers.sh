# OpenCL drivers to run the tests on. Sourced by ./dev, which gives $build, need_packages, say and fail.
#
# tests/devices/NAME.txt lists the tests that are left out with a driver, a line each: a regular expression, a
# tab, the reason.

drivers=(pocl intel rusticl oclgrind)
# With a slow driver: what uses the device, but for the command's tests, which train again and again.
slow_driver_tests='^(core|ops|optim|nn|search|golden|autograd|networks|sample|models|direct|experiments|train)_'
# Of those, what is small enough for a simulator.
simulator_tests='^(core_(bf16|context|tensor|kernel_form|kernel_cache|kernel_files|device|fields)|optim_(sgd|adam|optimizer|weight_mean)|'
simulator_tests+='ops_(layout|indices|empty|winograd|attention|derivatives)|nn_(frozen|state_dict)|search_index|autograd_(grad|graph)|'
simulator_tests+='networks_(bones|motion_losses))$'

# only_driver NAME LIBRARY: makes this the only driver that the OpenCL loader finds.
only_driver() {
  mkdir -p "$build/devices/$1"
  printf '%s\n' "$2" >"$build/devices/$1/driver.icd"
  export OCL_ICD_VENDORS=$build/devices/$1
}

# Intel's runtime for CPUs, from the Python package index, unpacked into the build folder: no root needed.
fetch_intel() {
  local folder=$build/devices/intel wheel
  [ ! -f "$folder/lib/libintelocl.so" ] || return 0
  need_packages python3-pip
  say "fetching Intel's OpenCL runtime"
  rm -rf "$folder"
  mkdir -p "$folder/wheels" "$folder/lib"
  python3 -m pip download -q --disable-pip-version-check --no-deps --only-binary :all: -d "$folder/wheels" \
    intel-opencl-rt intel-cmplr-lib-rt tbb tcmlib || fail "pip could not fetch Intel's runtime (see the messages above)"
  for wheel in "$folder"/wheels/*.whl; do python3 -m zipfile -e "$wheel" "$folder/unpacked"; done
  mv "$folder"/unpacked/*/data/lib/* "$folder/lib/"
  rm -rf "$folder/wheels" "$folder/unpacked" "$folder"/lib/libOpenCL.so*   # the loader is the system's
  ln -sf "$(cd "$folder/lib" && ls libintelocl.so.* | sort | tail -n 1)" "$folder/lib/libintelocl.so"
}

# use_driver NAME: prepares a driver for the programs that are started from here on. Another NAME is a device
# string (docs/devices.md).
use_driver() {
  case $1 in
    pocl)
      need_packages pocl-opencl-icd
      only_driver pocl "$(cat /etc/OpenCL/vendors/pocl.icd)"
      ;;
    intel)
      fetch_intel
      only_driver intel "$build/devices/intel/lib/libintelocl.so"
      export LD_LIBRARY_PATH=$build/devices/intel/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
      ;;
    rusticl)
      need_packages mesa-opencl-icd
      only_driver rusticl libRusticlOpenCL.so.1
      export RUSTICL_ENABLE=llvmpipe
      only_tests=$slow_driver_tests
      ;;
    oclgrind)
      need_packages oclgrind
      only_driver oclgrind /usr/lib/oclgrind/liboclgrind-rt-icd.so
      # Not OCLGRIND_UNINITIALIZED: it ends the program at LLVM's instruction `freeze`.
      export OCLGRIND_DATA_RACES=1 OCLGRIND_CHECK_API=1 OCLGRIND_MAX_ERRORS=5 MOTIONGAN_TEST_SINGLE=1
      only_tests=$simulator_tests
      ;;
    *) export MOTIONGAN_DEVICE=$1 ;;
  esac
}

# left_out NAME: a regular expression of the tests that are left out with a driver.
left_out() {
  local list=$root/tests/devices/$1.txt
  if [ -f "$list" ]; then grep -v '^#' "$list" | cut -f 1 | paste -s -d '|'; fi
}

# driver_summary NAME SECONDS RESULTS LOG: a row of the table, from what ctest printed and logged; to standard
# error, what failed and why. Fails if anything did.
driver_summary() {
  awk -v name="$1" -v seconds="$2" '
    FNR == NR {
      if ($2 != "Test" || $3 !~ /^#/) next
      test = $4
      status[test] = /Passed/ ? "passed" : /\*\*\*Skipped/ ? "skipped" : /\*\*\*Timeout/ ? "took too long" : "failed"
      next
    }
    /^[0-9]+\/[0-9]+ Test: / { test = $3 }
    /^\[doctest\] test cases:/ { cases["passed"] += $6; cases["failed"] += $9 }
    /^\[doctest\] unskipped test cases passing the current filters:/ { cases["left out"] += $NF }
    # What the simulator finds is an error, though the program knows nothing of it.
    /^(Invalid (read|write)|Read-write data race|Write-write data race|Uninitialized |Unaligned |Work-group divergence)/ {
      if (status[test] == "passed") { status[test] = "failed"; reason[test] = $0 }
    }
    !(test in reason) && /(ERROR: |CRASHED|[a-z] error: )/ {
      reason[test] = $0
      sub(/.*\/tests\//, "", reason[test])
    }
    END {
      for (test in status) {
        ++count[status[test] == "passed" || status[test] == "skipped" ? status[test] : "failed"]
        if (status[test] == "took too long") reason[test] = status[test]
        if (status[test] == "failed" && !(test in reason)) reason[test] = "said nothing that explains it"
        if (status[test] != "passed" && status[test] != "skipped")
          printf "%s: %s\n", test, substr(reason[test], 1, 200) > "/dev/stderr"
      }
      printf "| %s | %d | %d | %d | %d | %d | %d | %d min %d s |\n", name, count["passed"], count["skipped"], count["failed"],
        cases["passed"], cases["left out"], cases["failed"], seconds / 60, seconds % 60
      exit count["failed"] > 0
    }' "$3" "$4"
}

# test_on DRIVER [REGEX]: the tests with one driver; prints its row of the table.
test_on() {
  (
    use_driver "$1"
    local out=$build/devices/$1 omit only=${2:-${only_tests:-}} start=$SECONDS limit=600
    mkdir -p "$out"
    omit=$(left_out "$1")
    [ -z "${only_tests:-}" ] || limit=240
    "$build/motiongan" devices >"$out/device.txt" 2>&1 || fail "the driver $1 has no usable device: $(cat "$out/device.txt")"
    grep '^\*  ' "$out/device.txt" >&2
    ctest --test-dir "$build" --no-tests=error --timeout "$limit" -j "$jobs" ${only:+-R "$only"} ${omit:+-E "$omit"} >"$out/results.txt" 2>&1 || true
    cp "$build/Testing/Temporary/LastTest.log" "$out/log.txt"
    driver_summary "$1" $((SECONDS - start)) "$out/results.txt" "$out/log.txt"
  )
}

# run_matrix [DRIVER...]: the tests with all drivers, one after the other, and a table.
run_matrix() {
  local table driver failed=0
  [ $# -gt 0 ] || set -- "${drivers[@]}"
  table=$build/devices/matrix.md
  mkdir -p "$build/devices"
  printf '%s\n' '| driver | test programs passed | skipped | failed | test cases passed | left out | failed | time |' \
    '|---|---|---|---|---|---|---|---|' >"$table"
  for driver in "$@"; do
    say "$driver"
    test_on "$driver" >>"$table" || failed=$((failed + 1))
    grep -q "^| $driver |" "$table" || printf '| %s | could not be run | | | | | | |\n' "$driver" >>"$table"
    tail -n 1 "$table" >&2
  done
  cat "$table"
  [ "$failed" -eq 0 ] || fail "tests failed with $failed of $# drivers (logs: $build/devices/DRIVER/log.txt)"
}
