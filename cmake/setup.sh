# Sourced by cases/run and tests/run: packages, configuration, build. Stops with a clear word where a step fails.
set -euo pipefail

underbody_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf '== %s\n' "$*" >&2; }
fail() { printf '\nunderbody: %s\n' "$*" >&2; exit 1; }

# install_packages LIST...: what is missing of the Debian packages named in the lists.
install_packages() {
    local wanted missing=() name
    wanted=$(sed -e 's/#.*//' "$@" | tr -s '[:space:]' '\n' | sed '/^$/d')
    for name in $wanted; do
        dpkg-query -W -f='${Status}\n' "$name" 2>/dev/null | grep -q '^install ok installed' || missing+=("$name")
    done
    [ ${#missing[@]} -eq 0 ] && return 0
    command -v apt-get >/dev/null || fail "this is no Debian: install by hand: ${missing[*]}"
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || fail "packages are missing and there is no sudo: as root, run
    apt-get install --no-install-recommends ${missing[*]}"
        as_root=(sudo)
    fi
    say "installing Debian packages: ${missing[*]}"
    local log; log=$(mktemp)
    "${as_root[@]}" apt-get update >"$log" 2>&1 || { tail -5 "$log" >&2; fail "apt-get update failed (see above)"; }
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}" >"$log" 2>&1 \
        || { tail -15 "$log" >&2; fail "installing packages failed (see above)"; }
    rm -f "$log"
}

# build_release TARGET...: configures once, builds what changed.
build_release() {
    local folder=$underbody_root/build/release log=$underbody_root/build/release.log
    mkdir -p "$underbody_root/build"
    if [ ! -f "$folder/build.ninja" ]; then
        say "configuring (build/release)"
        (cd "$underbody_root" && cmake --preset release) >"$log" 2>&1 || { tail -30 "$log" >&2; fail "configuring failed (see above and $log)"; }
    fi
    say "building: $*"
    if [ -t 2 ]; then
        cmake --build "$folder" --target "$@" >&2 || fail "the build failed (see above)"
    else
        cmake --build "$folder" --target "$@" >"$log" 2>&1 || { grep -E 'error|FAILED' "$log" | head -40 >&2; fail "the build failed (see above and $log)"; }
    fi
}
