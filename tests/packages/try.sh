#!/usr/bin/env bash
# try.sh FOLDER: installs the packages of FOLDER into a bare Debian 12, in a folder that is removed afterwards, and uses
# them there: the command, a program in C++ by CMake and by pkg-config, one in C, the wheel. Needs root, debootstrap and
# a network.
set -euo pipefail
packages=$(cd "$1" && pwd)
project=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
[ "$(id -u)" -eq 0 ] || { echo "try.sh: needs to be root" >&2; exit 1; }

bare=$(mktemp -d)
chmod 755 "$bare"
remove() {
  for mounted in dev sys proc; do umount -l "$bare/$mounted" 2>/dev/null || true; done
  rm -rf --one-file-system -- "$bare"
}
trap remove EXIT
say() { printf 'try: %s\n' "$*"; }
quietly() { "$@" >"$bare/log" 2>&1 || { tail -n 20 "$bare/log" >&2; say "failed: $*"; exit 1; }; }
inside() { chroot "$bare" env -i HOME=/root PATH=/usr/bin:/bin:/usr/sbin:/sbin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash -ec "$*"; }

say "a bare Debian 12"
quietly debootstrap --variant=minbase bookworm "$bare"
mount -t proc proc "$bare/proc"
mount -t sysfs sys "$bare/sys"
mount --rbind /dev "$bare/dev"
mount --make-rslave "$bare/dev"
cp /etc/resolv.conf "$bare/etc/"
mkdir "$bare/root/try"
cp "$packages"/*.deb "$packages"/*.whl "$project"/examples/01_*.cpp "$project"/examples/c/stream.c "$project"/examples/python/stream.py \
  "$project"/tests/packages/CMakeLists.txt "$bare/root/try/"
quietly inside "apt-get update"

say "the command"
quietly inside "cd /root/try && apt-get install -y ./motiongan_*.deb"
inside "cd /root/try
  motiongan --version
  motiongan devices
  motiongan models
  motiongan generate cmu-text --text walk --out shipped
  motiongan generate cmu-stream --text walk --frames 200 --out shipped
  motiongan generate cmu-actions --class walk --seconds 3 --out shipped
  motiongan train dvgan --procedural 12 --generator rnn --hidden 16 --iterations 2 --batch 4 --save save
  motiongan generate save --text 'a person runs' --frames 50 --out made --html made.html
  ls made made.html
  test -s /usr/share/man/man1/motiongan.1.gz"

say "the library"
quietly inside "cd /root/try && apt-get install -y ./libmotiongan*.deb g++ cmake make pkg-config"
inside "cd /root/try
  cmake -S . -B build >/dev/null && cmake --build build
  (cd build && ./example)
  g++ -std=c++20 01_*.cpp -o by_pkg_config \$(pkg-config --cflags --libs motiongan)
  ./by_pkg_config
  gcc -std=c11 stream.c -o stream \$(pkg-config --cflags --libs motiongan-c)
  ./stream save run"

say "the wheel"
quietly inside "apt-get install -y python3-venv python3-numpy"
inside "cd /root/try
  python3 -m venv --system-site-packages venv
  venv/bin/pip install --quiet --no-index ./*.whl
  apt-get purge -y 'libmotiongan*' >/dev/null
  venv/bin/python stream.py save run
  cd / && root/try/venv/bin/python -c 'import motiongan as m; print(m.shipped_models(), m.Model(\"cmu-actions\").make(\"walk\", 60).frames)'"

say "removal"
quietly inside "apt-get purge -y motiongan"
left=$(inside "find /usr /etc /var/lib -path /var/lib/dpkg -prune -o -iname '*motiongan*' -print")
[ -z "$left" ] || { say "left behind: $left"; exit 1; }
say "all of it works"
