# Error against time and against work. ARG1 CSV of a scene, ARG2 title, ARG3 picture
set terminal pngcairo size 1650,600 font "DejaVu Sans,11" linewidth 1.2
set output ARG3
set datafile separator ","
set logscale xy
set format x "10^{%T}"
set format y "10^{%T}"
set grid xtics ytics lc rgb "#d8d8d8" lt 1 lw 0.7
set border 3 lc rgb "#444444"
set tics nomirror out
set mxtics 10
set mytics 1
set key off
rows = ARG1
pick(name) = "< awk -F, -v c='".name."' '$2==c && $16==1' ".rows." | sort -t, -k6,6g"
has(name) = system("awk -F, -v c='".name."' '$2==c && $16==1' ".rows." | wc -l") + 0
curves = "'deasim native' 'deasim linear' 'deasim cosim' 'ngspice' 'fixed exchange' 'scipy LSODA' 'scipy Radau' 'octave ode15s'"
array label[8] = ["deasim, native sources", "deasim, linear netlist", "deasim beside ngspice", "plain ngspice", \
    "fixed exchange", "scipy LSODA", "scipy Radau", "Octave ode15s"]
array colour[8] = ["#0072b2", "#56b4e9", "#002f5e", "#d55e00", "#8c8c8c", "#009e73", "#7fc97f", "#cc79a7"]
array mark[8] = [7, 5, 9, 13, 11, 6, 4, 8]
number(name) = name eq 'deasim native' ? 1 : name eq 'deasim linear' ? 2 : name eq 'deasim cosim' ? 3 : name eq 'ngspice' ? 4 : \
    name eq 'fixed exchange' ? 5 : name eq 'scipy LSODA' ? 6 : name eq 'scipy Radau' ? 7 : 8
shown = ""
do for [c in curves] { if (has(c) > 0) { shown = shown." '".c."'" } }

# the same errors in all three panels
stats "< awk -F, '$16==1 && $6>0' ".rows using 6 nooutput
low = 10**floor(log10(STATS_min))
high = 10**ceil(log10(STATS_max))
if (high < 10*low) { high = 10*low }
set yrange [low:high]

set multiplot title ARG2 noenhanced font "DejaVu Sans,14"
set tmargin at screen 0.90
set bmargin at screen 0.25

set lmargin at screen 0.055
set rmargin at screen 0.335
set ylabel "relative L_2 error over time, worst of x and port voltages"
set xlabel "whole process, s (median; whisker: least)"
plot for [c in shown] pick(c) using 7:6:8:7 with xerrorbars lc rgb colour[number(c)] pt mark[number(c)] ps 0.1, \
     for [c in shown] pick(c) using 7:6 with linespoints lc rgb colour[number(c)] pt mark[number(c)] ps 1.1 lw 1.8

unset ylabel
set lmargin at screen 0.385
set rmargin at screen 0.665
set xlabel "solving alone, s (least run less least start)"
plot for [c in shown] pick(c) using 11:6 with linespoints lc rgb colour[number(c)] pt mark[number(c)] ps 1.1 lw 1.8

set lmargin at screen 0.715
set rmargin at screen 0.985
set xlabel "residual calls + Newton iterations of the circuit"
sum(a, b) = (valid(a) ? column(a) : 0) + (valid(b) ? column(b) : 0)
plot for [c in shown] pick(c) using (sum(14, 15) > 0 ? sum(14, 15) : NaN):6 with linespoints \
    lc rgb colour[number(c)] pt mark[number(c)] ps 1.1 lw 1.8

# the legend below all of them
unset border
unset tics
unset xlabel
unset grid
unset logscale
set lmargin at screen 0.03
set rmargin at screen 0.98
set tmargin at screen 0.13
set bmargin at screen 0.01
set xrange [0:1]
set yrange [0:1]
set key at screen 0.52, screen 0.115 center top maxrows 2 width 1 samplen 2.5 reverse Left
plot for [c in shown] NaN with linespoints lc rgb colour[number(c)] pt mark[number(c)] ps 1.1 lw 1.8 title label[number(c)]
unset multiplot
