# shellcheck shell=bash
# Designs per second: closed forms, the general walk, and the energy scan of the paper. usage: design.sh PROGRAM
"$(dirname "$1")/bench/design"
