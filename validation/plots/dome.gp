# X.sky: three maps of the dome (dome.csv) with the neutral points (marks.csv); north up, east right.
width = 880; height = 292
load style
unset border; unset tics; unset grid; set key off
set size ratio -1
set xrange [-96:96]; set yrange [-96:96]
set parametric; set trange [0:2*pi]
set datafile missing '?'  # an image needs all its pixels; those outside of the dome are nan
set tmargin at screen 0.90; set bmargin at screen 0.04
set cbtics font ',11' scale 0.5
beside(x, y) = abs(y) > 75 ? x - 15 : x + 6  # no room beside a mark at the rim: its name is further in
under(y) = abs(y) > 75 ? y - 11*sgn(y) : y
array Column[3]; Column[1] = 'I'; Column[2] = 'DoLP'; Column[3] = 'AoLP_deg'
array Title[3]; Title[1] = 'radiance'; Title[2] = 'DoLP'; Title[3] = 'AoLP [deg]'
set multiplot
do for [i = 1:3] {
  set lmargin at screen (i - 1) * 0.333 + 0.01
  set rmargin at screen (i - 1) * 0.333 + 0.262
  set title Title[i] offset 0,-0.6
  if (i < 3) { @level_map; set cbrange [0:*] }
  if (i == 3) { set palette model HSV defined (0 0 0.7 0.9, 1 1 0.7 0.9); set cbrange [0:180]; set cbtics 45 }
  set colorbox user origin screen (i - 1) * 0.333 + 0.272, 0.14 size screen 0.008, 0.62
  plot 'dome.csv' using 'x':'y':(column(Column[i])) with image, \
       90*cos(t),90*sin(t) with lines linecolor rgb '#808080' linewidth 1 dashtype solid, \
       'marks.csv' using 'x':'y' with points pointtype 6 pointsize 0.8 linewidth 1.5 linecolor rgb '#ffffff', \
       'marks.csv' using (beside(column('x'), column('y'))):(under(column('y'))):(strcol('name')) with labels left font ',10' textcolor rgb '#ffffff'
}
unset multiplot
