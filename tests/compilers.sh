# Builds with other compilers. Sourced by ./dev, which gives $root, $build, $jobs, say and fail.

known_compilers() {
  local name
  for name in g++-{12..16} clang++-{14..22}; do
    if command -v "$name" >/dev/null; then printf '%s\n' "$name"; fi
  done
}

# build_with COMPILER STANDARD: the command and the C library, without optimisation; warnings are errors.
build_with() {
  local folder=$build/compilers/$1-$2
  mkdir -p "$folder"
  # The system's libraries may be made with a newer GCC than this one; what they lack is in the system's libstdc++.
  local newer=-Wl,--allow-shlib-undefined
  cmake -S "$root" -B "$folder" -G Ninja -DCMAKE_CXX_COMPILER="$1" -DCMAKE_CXX_STANDARD="$2" -DCMAKE_BUILD_TYPE=None \
    "-DCMAKE_EXE_LINKER_FLAGS=$newer" "-DCMAKE_SHARED_LINKER_FLAGS=$newer" -DMOTIONGAN_WERROR=ON \
    -DMOTIONGAN_BUILD_TESTS=OFF -DMOTIONGAN_BUILD_EXAMPLES=OFF -DMOTIONGAN_BUILD_BENCHMARKS=OFF \
    >"$folder/log.txt" 2>&1 &&
    cmake --build "$folder" -j "$jobs" >>"$folder/log.txt" 2>&1 &&
    "$folder/motiongan" --version >>"$folder/log.txt" 2>&1
}

# build_with_libcxx COMPILER STANDARD: the headers with Clang's standard library, in a program that is run. The
# command is left out: the libraries that it links were compiled with the other one. Clang 14 calls C++23 C++2b.
build_with_libcxx() {
  local folder=$build/compilers/$1-$2-libc++
  mkdir -p "$folder"
  (cd "$root" && "$1" "-std=c++${2/23/2b}" -stdlib=libc++ -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror \
    -Iinclude "-I$build/generated" tests/second_unit.cpp tests/second_unit_main.cpp -lOpenCL -lclblast -lz -o "$folder/second_unit" &&
    "$folder/second_unit") >"$folder/log.txt" 2>&1
}

# run_compilers [COMPILER...]: all of them, or those that are installed; prints a table.
run_compilers() {
  local compiler standard failed=0 start
  # shellcheck disable=SC2046  # names without spaces
  [ $# -gt 0 ] || set -- $(known_compilers)
  [ $# -gt 0 ] || fail "no compiler found of g++-12 or later and clang++-14 or later"
  # The generated headers.
  configure
  one() {
    start=$SECONDS
    if "$2" "$compiler" "$standard"; then
      printf '| %s | C++%s | %s | builds, runs | %d s |\n' "$compiler" "$standard" "$1" $((SECONDS - start))
    else
      failed=$((failed + 1))
      printf '| %s | C++%s | %s | FAILS: %s |\n' "$compiler" "$standard" "$1" \
        "$(grep -h -m 1 -E 'error|Error' "$build/compilers/$compiler-$standard$3/log.txt" | cut -c 1-200)"
    fi
  }
  printf '%s\n' '| compiler | standard | standard library | command and C library; with libc++ the headers | time |' '|---|---|---|---|---|'
  for compiler in "$@"; do
    for standard in 20 23; do
      one libstdc++ build_with ''
      if [[ $compiler == clang* ]] && echo '#include <version>' | "$compiler" -stdlib=libc++ -x c++ -fsyntax-only - 2>/dev/null; then
        one libc++ build_with_libcxx -libc++
      fi
    done
  done
  [ "$failed" -eq 0 ] || fail "$failed builds failed (logs: $build/compilers/*/log.txt)"
}
