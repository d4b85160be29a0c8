# shellcheck shell=bash
# Work and time with and without each thing a run leaves out: a table, and docs/performance/skipping.csv.
# usage: skipping.sh PROGRAM
set -euo pipefail
mkdir -p docs/performance
"$(dirname "$1")/tests/stress_skipping" docs/performance/skipping.csv
