# Delivered against asked accuracy. ARG1 rows, ARG2 picture
set terminal pngcairo size 900,800 font "sans,11"
set output ARG2
set datafile separator ","
set logscale xy
set format "10^{%T}"
set grid
set key top left
set xrange [3e-7:3e-2]
set yrange [1e-10:1e-1]
set xlabel "asked: relative L_2 error of displacement and port voltages"
set ylabel "delivered (the worse of the two)"
rows(mode) = "< awk -F, -v m='".mode."' '$2==m && $13==1' ".ARG1
modes = "static native linear cosim"
array colour[4] = ["#009e73", "#0072b2", "#56b4e9", "#d55e00"]
has(mode) = system("awk -F, -v m='".mode."' '$2==m && $13==1' ".ARG1." | wc -l") + 0
shown = ""
do for [i = 1:4] { if (has(word(modes, i)) > 0) { shown = shown.sprintf(" %d", i) } }
shift(i) = 10 ** (0.09 * (i - 2.5))
plot x with lines lc rgb "black" lw 2 title "delivered = asked", x / 30 with lines dt 2 lc rgb "black" title "a thirtieth", \
    for [i in shown] rows(word(modes, i + 0)) using ($3 * shift(i)):4 with points pt 6 ps 0.8 lc rgb colour[i + 0] title word(modes, i + 0)
