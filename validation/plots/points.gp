# X.sampling: three sets of 64 points (points.csv), the cells of the 8 x 8 grid, and their shadows on both axes.
width = 840; height = 326
load style
set size ratio -1
set xrange [-0.1:1.02]; set yrange [-0.1:1.02]
unset border; unset tics; unset grid
set tmargin at screen 0.92; set bmargin at screen 0.02
array Names[3]; Names[1] = 'random'; Names[2] = 'grid'; Names[3] = 'sobol'
array Title[3]; Title[1] = 'random'; Title[2] = 'grid'; Title[3] = 'scrambled Sobol'
do for [k = 0:8] {
  set arrow from 0, k / 8.0 to 1, k / 8.0 nohead linecolor rgb '#b8b8b8' linewidth 0.6
  set arrow from k / 8.0, 0 to k / 8.0, 1 nohead linecolor rgb '#b8b8b8' linewidth 0.6
}
set multiplot
do for [i = 1:3] {
  set lmargin at screen (i - 1) * 0.333 + 0.01
  set rmargin at screen (i - 1) * 0.333 + 0.323
  set title Title[i] offset 0,-0.7
  plot 'points.csv' using (column(Names[i] . '_x')):(column(Names[i] . '_y')) with points linetype 1 pointtype 7 pointsize 0.55, \
       '' using (column(Names[i] . '_x')):(-0.07):(0):(0.04) with vectors nohead linetype 2 linewidth 1 dashtype solid, \
       '' using (-0.07):(column(Names[i] . '_y')):(0.04):(0) with vectors nohead linetype 2 linewidth 1 dashtype solid
}
unset multiplot
