#!/bin/sh
# Figure 5B of Rosset et al.: largest displacement over the total length, same axes as 5A. The cross is the optimum:
# d = 0.06452 at r_a = 0.4677, lp1 = 0.8836; the paper reads 0.065 at 0.46 and 0.88.
# Runs deasim where it is installed, else the one built here.
exec "${DEASIM:-$(command -v deasim || echo "$(dirname "$0")/../../build/release/deasim")}" map --x r_a=0:1 --y lp1=0.6:1.8 --set lp2=2 --of displacement -n 401x401 -o figure-5b "$@"
