# X.measured: error of interpolation against the steps of a table; half-way angles full, plain ones dashed.
width = 640; height = 480
load style
set logscale xy
set xrange [7:56]; set xtics (8, 12, 16, 24, 32, 48)
set yrange [0.0005:0.5]
set format y '10^{%T}'
set xlabel 'steps of each polar angle'
set ylabel 'relative error (rms)'
set bmargin 7.5
set key at screen 0.5,0.02 center bottom maxrows 2 spacing 1.1 Left reverse samplen 2
plot 'error.csv' using 'steps':'half_01' with linespoints linetype 1 dashtype 1 title 'σ = 0.1, half-way angles', \
     'error.csv' using 'steps':'plain_01' with linespoints linetype 1 dashtype 2 title 'σ = 0.1, plain angles', \
     'error.csv' using 'steps':'half_03' with linespoints linetype 2 dashtype 1 title 'σ = 0.3, half-way angles', \
     'error.csv' using 'steps':'plain_03' with linespoints linetype 2 dashtype 2 title 'σ = 0.3, plain angles'
