#!/bin/sh
# Figure 5A of Rosset et al.: largest actuation stretch over active ratio and prestretch along the motion, at lp2 = 2.
# The white line parts loss of tension (below) from dielectric breakdown. Further options are passed on.
# Runs deasim where it is installed, else the one built here.
exec "${DEASIM:-$(command -v deasim || echo "$(dirname "$0")/../../build/release/deasim")}" map --x r_a=0:1 --y lp1=0.6:1.8 --set lp2=2 --of stretch -n 401x401 -o figure-5a "$@"
