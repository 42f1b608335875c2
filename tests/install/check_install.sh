#!/usr/bin/env bash
# check_install.sh BUILD CONSUMER: installs into a temporary prefix, builds the consumer against it, runs it.
set -euo pipefail
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --install "$1" --prefix "$scratch/prefix" >"$scratch/install.log" || { cat "$scratch/install.log"; exit 1; }
for study in evie evie-pitch; do  # the shipped studies, without what was made from them
    folder=$scratch/prefix/share/underbody/cases/$study
    [ -s "$folder/study.toml" ] && [ ! -e "$folder/.underbody" ] || { echo "$folder is not as shipped" >&2; exit 1; }
done
cmake -G Ninja -S "$2" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$scratch/prefix" -DCMAKE_BUILD_TYPE=Debug >"$scratch/cmake.log" 2>&1 \
    || { cat "$scratch/cmake.log"; exit 1; }
cmake --build "$scratch/build"
"$scratch/build/consumer"
