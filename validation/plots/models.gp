# X.*: a model in the common style: f00.csv, dolp.csv (in plane, light from 45 deg), dhr.csv; a column for each curve.
width = 1080; height = 380
load style
stats 'f00.csv' using 1 skip 1 nooutput
curves = STATS_columns
set multiplot
set key top left Left reverse samplen 2
set origin 0,0; set size 0.36,1; set lmargin 9; set rmargin 2
set xrange [-90:90]; set xtics 30
set xlabel 'view zenith [deg], source at -45'
set title 'f_{00} [sr^{-1}]'
set yrange [0:*]; set offsets 0,0,graph 0.3,0
plot for [i=2:curves] 'f00.csv' using 1:i with lines title columnheader(i)
unset key; unset offsets
set origin 0.36,0; set size 0.32,1; set lmargin 6
set title 'degree of linear polarisation'
set yrange [0:1]
plot for [i=2:curves] 'dolp.csv' using 1:i with lines
set origin 0.68,0; set size 0.32,1
set xrange [0:90]; set xlabel 'angle of incidence [deg]'
set title 'reflectance (DHR)'
set yrange [0:*]
plot for [i=2:curves] 'dhr.csv' using 1:i with lines
unset multiplot
