# X.sun: radiance of the sun's image in glass of n = 1.5 at 60 degrees; irradiance 1 (glint.csv).
width = 760
load style
set logscale xy
set xlabel 'standard deviation of the slopes'
set ylabel 'radiance, 1/sr'
set format x '10^{%L}'
set format y '10^{%L}'
set xrange [8e-7:0.15]
set yrange [0.3:1e5]
set key left bottom
set datafile missing 'nan'
plot 'glint.csv' using 'sigma':'point_sun' with lines linestyle 12 title 'a point sun', \
     '' using 'sigma':'mirror' with lines linestyle 12 dashtype (12,6) title 'reflectance × disk', \
     '' using 'sigma':'disk_sum' with lines linetype 1 title 'sum over the disk', \
     '' using 'sigma':'malus' with points linetype 2 title 'malus'
