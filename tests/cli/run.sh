#!/usr/bin/env bash
# Runs every tests/cli/test_*.sh (or those named after the program), each in an empty folder of its own, with
#   DEASIM       the program
#   ROOT         the top of the source tree
# in the environment. A test passes when it exits with 0. usage: run.sh [PROGRAM [TEST...]]
set -uo pipefail
cli=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
ROOT=$(cd "$cli/../.." && pwd)
DEASIM=$(realpath "${1:-$ROOT/build/release/deasim}")
export ROOT DEASIM
shift $(($# > 0))
if (($#)); then tests=("$@"); else tests=("$cli"/test_*.sh); fi

passed=0
failed=0
for path in "${tests[@]}"; do
    [[ $path == "$cli/test_*.sh" ]] && continue # none there
    path=$(realpath "$path")
    name=$(basename "$path" .sh)
    folder=$(mktemp -d)
    started=$SECONDS
    if (cd "$folder" && timeout --kill-after=10 "${DEASIM_TEST_TIMEOUT:-300}" bash -eu -o pipefail "$path") \
        >"$folder.out" 2>&1 </dev/null; then
        printf 'pass: cli/%s (%d s)\n' "$name" $((SECONDS - started))
        ((passed += 1))
    else
        status=$?
        ((status == 124 || status == 137)) && echo "(ran into the time limit)" >>"$folder.out"
        printf 'FAIL: cli/%s (exit code %d)\n' "$name" "$status"
        sed 's/^/    /' "$folder.out"
        ((failed += 1))
    fi
    rm -rf "$folder" "$folder.out"
done
printf '%d passed, %d failed\n' "$passed" "$failed"
((failed == 0))
