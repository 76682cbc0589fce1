# X.sampling: error of S0 of the copper chunky bar against the number of rays (convergence.csv).
width = 760
load style
set logscale xy
set xrange [13:160]
set yrange [0.02:1.2]
set xtics (16, 32, 64, 128)
set xlabel 'rays from the first surface'
set ylabel 'rms error of S_0 / mean S_0'
set format y '%g'
set key outside right top
stats 'convergence.csv' using 'importance' nooutput name 'i'
a = 1.15 * i_max * sqrt(16)
plot 'convergence.csv' using 'rays':'random' with linespoints linetype 1 title 'random', \
     '' using 'rays':'grid' with linespoints linetype 2 title 'grid', \
     '' using 'rays':'gridRotated' with linespoints linetype 3 title 'grid, turned', \
     '' using 'rays':'adaptive' with linespoints linetype 4 title 'adaptive', \
     '' using 'rays':'importance' with linespoints linetype 5 title 'importance', \
     '' using 'rays':'sobol' with linespoints linetype 6 title 'importance, Sobol', \
     '' using 'rays':'images' with linespoints linetype 7 title 'images of the sun', \
     a / sqrt(x) with lines linestyle 12 title 'slope −1/2', \
     a * 4 / x with lines linestyle 12 dashtype (12,6) title 'slope −1'
