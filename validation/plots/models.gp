# X.*: a model in the common style: f00.csv, dolp.csv (in plane, light from 45 deg), dhr.csv; a column for each curve.
width = 1080; height = 450
load style
stats 'f00.csv' using 1 skip 1 nooutput
curves = STATS_columns
set multiplot
unset key
set xrange [-90:90]; set xtics 30
set xlabel 'view zenith [deg], source at -45'
set origin 0,0.14; set size 0.36,0.86; set lmargin 9; set rmargin 2
set title 'f_{00} [sr^{-1}]'
set yrange [0:*]
plot for [i=2:curves] 'f00.csv' using 1:i with lines
set origin 0.36,0.14; set size 0.32,0.86; set lmargin 6
set title 'degree of linear polarisation'
set yrange [0:1]
plot for [i=2:curves] 'dolp.csv' using 1:i with lines
set origin 0.68,0.14; set size 0.32,0.86
set xrange [0:90]; set xlabel 'angle of incidence [deg]'
set title 'reflectance (DHR)'
set yrange [0:*]
plot for [i=2:curves] 'dhr.csv' using 1:i with lines
# the titles of all curves in a row below, by a plot of nothing
set origin 0,0; set size 1,0.13
set lmargin 0; set rmargin 0; set tmargin 0; set bmargin 0
unset title; unset xlabel; unset border; unset tics; unset grid
set yrange [0:1]
set key center center horizontal Left reverse samplen 3 width 2
plot for [i=2:curves] 'f00.csv' using (0):(column(i) > 0 ? NaN : NaN) with lines linetype i-1 title columnheader(i)
unset multiplot
