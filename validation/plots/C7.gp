# C7: error of the index recovered by the experiment of chapter 8, over n and k (map.csv) and noise (noise.csv).
width = 860; height = 420
load style
set multiplot
set lmargin 11; set rmargin 3
set logscale xy
set origin 0,0; set size 0.5,1
set xlabel 'k'; set ylabel 'error of the index [%]'
set xrange [0.08:6]; set yrange [*:*]
set key top left Left reverse samplen 2
plot for [i=2:5] 'map.csv' using 1:i with linespoints title columnheader(i)
set origin 0.5,0; set size 0.5,1
set xlabel 'noise [%]'
set xrange [0.2:15]; set yrange [0.5:100]
set key top left Left reverse samplen 2
plot 'noise.csv' using 'noise_percent':'stated_percent' with lines title 'stated', \
     '' using 'noise_percent':'found_percent' with points pointtype 7 title 'found'
unset multiplot
