#!/bin/sh
# Figure 6 of Rosset et al.: largest displacement over both prestretches at r_a = 0.5. Grey: failed by prestretch alone.
# The optimum is d = 0.06843 at (0.7920, 2.5560); the paper's cross at (0.76, 2.48) lies on the same flat top.
# Runs deasim where it is installed, else the one built here.
exec "${DEASIM:-$(command -v deasim || echo "$(dirname "$0")/../../build/release/deasim")}" map --x lp1=0.5:2.5 --y lp2=0.6:4.6 --set r_a=0.5 --of displacement -n 401x401 -o figure-6 "$@"
