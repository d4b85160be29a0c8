# shellcheck shell=bash
# Cost of many devices in one netlist beside the circuit's own; table in docs/performance. usage: many_devices.sh PROGRAM
set -euo pipefail
tools=$(dirname "$1")/bench
work=out/bench/many_devices
mkdir -p "$work" docs/performance
"$tools/many_devices" "$1" "$tools/fixed_capacitor" "$PWD/models/planar_c_s5.yaml" "$work" \
    docs/performance/many_devices.csv
