# Error against run time, and against what does not depend on the machine. ARG1 rows, ARG2 scene, ARG3 picture
set terminal pngcairo size 1500,640 font "sans,11"
set output ARG3
set datafile separator ","
set logscale xy
set format "10^{%T}"
set grid
set key outside below maxrows 3
curves = "'deasim native' 'deasim linear' 'deasim cosim' 'ngspice' 'fixed exchange' 'scipy LSODA' 'scipy Radau' 'octave ode15s'"
rows = "< awk -F, -v s='".ARG2."' '$1==s && $14==1' ".ARG1." | sort -t, -k2,2 -k6,6g"
pick(name) = "< awk -F, -v s='".ARG2."' -v c='".name."' '$1==s && $2==c && $14==1' ".ARG1." | sort -t, -k6,6g"
has(name) = system("awk -F, -v s='".ARG2."' -v c='".name."' '$1==s && $2==c && $14==1' ".ARG1." | wc -l") + 0
shown = ""
do for [c in curves] { if (has(c) > 0) { shown = shown." '".c."'" } }
array colour[8] = ["#0072b2", "#56b4e9", "#003c66", "#d55e00", "#999999", "#009e73", "#66c2a5", "#cc79a7"]
number(name) = name eq 'deasim native' ? 1 : name eq 'deasim linear' ? 2 : name eq 'deasim cosim' ? 3 : name eq 'ngspice' ? 4 : \
    name eq 'fixed exchange' ? 5 : name eq 'scipy LSODA' ? 6 : name eq 'scipy Radau' ? 7 : 8
set multiplot layout 1,2 title ARG4 noenhanced
set xlabel "relative L_2 error of displacement and port voltages (worse of the two)"
set ylabel "wall time of the process, s (median; whisker: least)"
plot for [c in shown] pick(c) using 6:7:8:7 with yerrorbars lc rgb colour[number(c)] pt number(c)+3 ps 1 notitle, \
     for [c in shown] pick(c) using 6:7 with linespoints lc rgb colour[number(c)] pt number(c)+3 lw 2 title c noenhanced
set ylabel "calls of the residual + Newton iterations of the circuit"
sum(a, b) = (valid(a) ? column(a) : 0) + (valid(b) ? column(b) : 0)
plot for [c in shown] pick(c) using 6:(sum(12, 13) > 0 ? sum(12, 13) : NaN) with linespoints \
    lc rgb colour[number(c)] pt number(c)+3 lw 2 title c noenhanced
unset multiplot
