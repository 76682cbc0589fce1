# X.thermal: error of the surface temperature by the length of the steps (steps.csv) and the number of cells (cells.csv).
width = 900; height = 420
load style
set multiplot layout 1,2
set logscale xy
set format y '10^{%T}'
set xtics font ',12'
set ylabel 'largest error [K]'
set key bottom right
set xlabel 'step [s]'
set xrange [180:9000]
set xtics (225, 450, 900, 1800, 3600, 7200)
stats 'steps.csv' using (column('step_s') == 900 ? column('soil') : NaN) nooutput name 's'
plot 'steps.csv' using 'step_s':'soil' with linespoints linetype 1 title 'soil', \
     '' using 'step_s':'copper' with linespoints linetype 2 title 'copper plate', \
     s_max * (x / 900.0)**2 with lines linestyle 12 title 'slope 2'
set key bottom left
set yrange [1e-12:1]
set xlabel 'cells'
set xrange [7:300]
set xtics (8, 16, 32, 64, 128, 256)
stats 'cells.csv' using 'soil' nooutput name 'c'
plot 'cells.csv' using 'cells':'soil' with linespoints linetype 1 title 'soil', \
     '' using 'cells':'copper' with linespoints linetype 2 title 'copper plate', \
     c_max * (8.0 / x)**2 with lines linestyle 12 title 'slope −2'
unset multiplot
