#!/usr/bin/env bash
# Fails on a source that clang-format would change (.clang-format). To mend: clang-format -i FILE...
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
command -v clang-format >/dev/null || { echo "skipped: clang-format is not installed"; exit 77; }
find core geometry postproc surrogates cases studio tests -path tests/data -prune -o -type f \( -name '*.h' -o -name '*.cpp' \) -print0 |
    xargs -0 -P "$(nproc)" -n 40 clang-format --dry-run -Werror
