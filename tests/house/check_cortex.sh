#!/usr/bin/env bash
# check_cortex.sh UNDERBODY: what README.md and docs/performance.md say of the headers on microcontrollers is what
# tests/bench/tables/cortex counts: bytes exactly, instructions (executed, no times) within 1 %, since without a unit for
# floating point they hang on the digits of the numbers.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
for needed in arm-none-eabi-gcc qemu-system-arm; do
    command -v "$needed" >/dev/null || { echo "skipped: there is no $needed (apt-get install gcc-arm-none-eabi qemu-system-arm)"; exit 77; }
done
case $(arm-none-eabi-gcc -dumpversion) in
    12.2*) ;;
    *) echo "skipped: the figures are those of arm-none-eabi-gcc 12.2, here is $(arm-none-eabi-gcc -dumpversion)"; exit 77 ;;
esac
counted=$(mktemp)
trap 'rm -f "$counted"' EXIT
"$root/tests/bench/tables/cortex" "$1" 2>/dev/null >"$counted"
[ "$(grep -c Cortex "$counted")" -ge 15 ] || { echo "only $(grep -c Cortex "$counted") rows were counted"; exit 1; }
bad=0
documented=$(mktemp)
trap 'rm -f "$counted" "$documented"' EXIT
grep -E '^\| (lift|three)_[a-z]+ \|.*\| Cortex-M' "$root/docs/performance.md" >"$documented"
awk -F' *[|] *' '
{ key = $2 " | " $3 " | " $4 " | " $5; bytes = $6 " | " $7 " | " $8 }
NR == FNR { said[key] = bytes; instructions[key] = $9; next }
$5 ~ /Cortex/ && (!(key in said) || said[key] != bytes || $9 > 1.01 * instructions[key] || $9 < 0.99 * instructions[key]) {
    print "not in docs/performance.md: " $0; bad = 1
}
END { exit bad }' "$documented" "$counted" || bad=1
# README: code from the least to the most of the cores, constants, then instructions and stack of each core.
awk -F'|' '
function with_commas(n) { return n >= 1000 ? int(n / 1000) "," sprintf("%03d", n % 1000) : n + 0 }
$2 ~ /lift_/ {
    name = $2; gsub(/[ ]|lift_/, "", name)
    if (!(name in least) || $6 + 0 < least[name]) least[name] = $6 + 0
    if ($6 + 0 > most[name]) most[name] = $6 + 0
    constants[name] = $7 + 0
    cores[name] = cores[name] " " with_commas($9 + 0) "; " ($8 + 0) " B |"
}
END {
    for (name in least)
        print "| " (name == "fixed" ? "fixed point" : name) " | " with_commas(least[name]) " to " with_commas(most[name]) " | " \
            with_commas(constants[name]) " |" cores[name]
}' "$documented" >"$counted.rows"
[ "$(wc -l <"$counted.rows")" = 3 ] || { echo "not three rows for README.md"; bad=1; }
while read -r row; do
    grep -qxF "$row" "$root/README.md" || { echo "not in README.md: $row"; bad=1; }
done <"$counted.rows"
rm -f "$counted.rows"
exit "$bad"
