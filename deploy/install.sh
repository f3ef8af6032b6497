#!/usr/bin/env bash
# Installs what building needs on Debian 12, with --tests also what the tests and checks need, with --bench also what the
# benchmarks need. Does nothing if all is there.
set -euo pipefail

packages=(g++ cmake ninja-build libboost-dev libprotobuf-dev protobuf-compiler libeigen3-dev libspdlog-dev libcli11-dev
          libzstd-dev zlib1g-dev libssl-dev libusb-1.0-0-dev)
if [[ "${1:-}" == --tests || "${1:-}" == --bench ]]; then
  # MuJoCo and KDL serve as independent oracles; MuJoCo's CMake files ask for qhull and OpenGL.
  packages+=(libgtest-dev nlohmann-json3-dev libmujoco-dev libqhull-dev libgl-dev liborocos-kdl-dev valgrind iproute2
             libumockdev-dev umockdev pkg-config clang clang-format clang-tidy libclang-rt-14-dev llvm-14)
  # Another reader of recordings, in JavaScript; node from elsewhere will do.
  command -v node >/dev/null && command -v npm >/dev/null || packages+=(nodejs npm)
fi
[[ "${1:-}" == --bench ]] && packages+=(libbenchmark-dev)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
done
(( ${#missing[@]} == 0 )) && exit 0

as_root=()
(( EUID == 0 )) || as_root=(sudo)
echo "installing: ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
