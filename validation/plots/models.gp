# X.*: a model in the common style: f00.csv, dolp.csv (in plane, light from 45 deg), dhr.csv; a column for each curve.
width = 860; height = 400
load style
stats 'f00.csv' using 1 skip 1 nooutput
curves = STATS_columns
# names of columns are plain letters
swapped(s, a, b) = (p = strstrt(s, a)) > 0 ? s[1:p - 1] . b . s[p + strlen(a):strlen(s)] : s
name(s) = swapped(swapped(s, 'sigma', 'σ ='), ' um', ' µm')

polarises = 0
do for [i=2:curves] {
  stats 'dolp.csv' using i nooutput
  if (STATS_max > 1e-6) { polarises = 1 }
}
set multiplot
unset key
set xrange [-90:90]; set xtics 45
set xlabel 'view zenith [deg]'
set tmargin 3; set bmargin 4
set origin 0,0.14; set size 0.35,0.86; set lmargin 7.5; set rmargin 1.5
set title 'f_{00} [sr^{-1}]'
set yrange [0:*]; set offsets 0, 0, graph 0.2, 0
# where the light comes from
set arrow 1 from first -45, graph 1.0 to first -45, graph 0.91 size graph 0.03,25 filled linecolor rgb '#b07800' linewidth 2
set label 1 'light' at first -45, graph 0.86 center font ',12' textcolor rgb '#8a5d00'
plot for [i=2:curves] 'f00.csv' using 1:i with lines
set origin 0.345,0.14; set size 0.33,0.86; set lmargin 6
set title 'DoLP'
set offsets 0, 0, 0, 0; set yrange [0:1]
if (!polarises) { set label 2 "zero:\nnot polarised" at graph 0.5, graph 0.5 center textcolor rgb '#6d675d' }
plot for [i=2:curves] 'dolp.csv' using 1:i with lines
unset label; unset arrow
set origin 0.67,0.14; set size 0.33,0.86
set xrange [0:90]; set xtics 30; set xlabel 'angle of incidence [deg]'
set title 'reflectance (DHR)'
set yrange [0:*]
plot for [i=2:curves] 'dhr.csv' using 1:i with lines
# the titles of all curves in a row below, by a plot of nothing
set origin 0,0; set size 1,0.13
set lmargin 0; set rmargin 0; set tmargin 0; set bmargin 0
unset title; unset xlabel; unset border; unset tics; unset grid
set yrange [0:1]
set key center center horizontal Left reverse samplen 2.5 width -0.5 font ',12'
plot for [i=2:curves] 'f00.csv' using (0):(column(i) > 0 ? NaN : NaN) with lines linetype i-1 title name(columnheader(i))
unset multiplot
