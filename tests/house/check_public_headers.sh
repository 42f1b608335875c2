#!/usr/bin/env bash
# Fails where a public header (cmake/public_headers.txt: what is installed) is missing, listed twice, or includes one of
# the project's that is not public. That they compile without the project's sources is shown by the installed consumer (tests/install).
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
list=cmake/public_headers.txt
bad=0
sort -c -u "$list" 2>/dev/null || { echo "$list is to be sorted, each header once"; bad=1; }
while read -r header; do
    [ -f "$header" ] || { echo "$list names $header, which does not exist"; bad=1; continue; }
    while read -r included; do
        grep -qxF "$included" "$list" || { echo "$header is public and includes $included, which is not in $list"; bad=1; }
    done < <(sed -nE 's,^#include "([^"]+)".*,\1,p' "$header")
done < "$list"
exit $bad
