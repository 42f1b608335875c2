#!/usr/bin/env bash
# check_install.sh BUILD CONSUMER: installs into a temporary prefix, builds the consumer against it, runs it.
set -euo pipefail
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --install "$1" --prefix "$scratch/prefix" >"$scratch/install.log" || { cat "$scratch/install.log"; exit 1; }
# A file that two rules install is the one or the other, by the dates of the files: packages of two builds then differ.
twice=$(sort "$1/install_manifest.txt" | uniq -d)
[ -z "$twice" ] || { echo "installed by two rules: $twice" >&2; exit 1; }
for study in evie evie-pitch; do  # the shipped studies, without what was made from them
    folder=$scratch/prefix/share/underbody/cases/$study
    [ -s "$folder/study.toml" ] && [ ! -e "$folder/.underbody" ] || { echo "$folder is not as shipped" >&2; exit 1; }
done
# What the desktop entry says it opens is a type that the desktop then knows, with an icon that is there.
share=$scratch/prefix/share
if [ -f "$share/applications/org.underbody.studio.desktop" ]; then
    for type in $(sed -n 's/^MimeType=//p' "$share/applications/org.underbody.studio.desktop" | tr ';' ' '); do
        for file in "$share/mime/packages/org.underbody.studio.xml" "$share/metainfo/org.underbody.studio.metainfo.xml"; do
            grep -q "$type" "$file" || { echo "$(basename "$file") knows no $type" >&2; exit 1; }
        done
    done
    ls "$share"/icons/hicolor/*/apps/org.underbody.studio.* >/dev/null
fi
# Two builds give equal bytes only where nothing that is installed says in which folder it was built.
if grep -q '^CMAKE_BUILD_TYPE:STRING=Release$' "$1/CMakeCache.txt"; then
    source=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$1/CMakeCache.txt")
    if grep -rlaF "$source/" "$scratch/prefix" | grep . >&2; then
        echo "these name the folder that they were built in, $source" >&2
        exit 1
    fi
    grep -rlaF underbody "$scratch/prefix/bin" >/dev/null  # it does find words in programs
fi
cmake -G Ninja -S "$2" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$scratch/prefix" -DCMAKE_BUILD_TYPE=Debug >"$scratch/cmake.log" 2>&1 \
    || { cat "$scratch/cmake.log"; exit 1; }
cmake --build "$scratch/build"
"$scratch/build/consumer"
