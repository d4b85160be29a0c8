# shellcheck shell=bash
# Sourced by the tests: runs commands and compares what came out. A failed expectation ends the test.

# expect CODE COMMAND...: runs a command, keeps its stdout and stderr in the files `out` and `err`, compares the exit code.
expect() {
    local wanted=$1 code=0
    shift
    "$@" >out 2>err || code=$?
    ((code == wanted)) && return 0
    printf 'exit code %d instead of %d: %s\n--- stdout\n' "$code" "$wanted" "$*"
    tail -n 20 out
    printf -- '--- stderr\n'
    tail -n 20 err
    exit 1
}

# has FILE TEXT: the file holds this text, taken literally.
has() {
    grep -qF -- "$2" "$1" && return 0
    printf '%s lacks: %s\n--- %s\n' "$1" "$2" "$1"
    tail -n 20 "$1"
    exit 1
}

# lacks FILE TEXT: the opposite.
lacks() {
    grep -qF -- "$2" "$1" || return 0
    printf '%s must not hold: %s\n' "$1" "$2"
    grep -nF -- "$2" "$1"
    exit 1
}
