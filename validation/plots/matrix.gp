# X.torrance-sparrow: the sixteen elements of a Mueller matrix over the hemisphere of views (matrix.csv).
# f00 by itself, the others divided by it; light from the left.
width = 760; height = 690
load style
unset border; unset tics; unset grid; set key off
set size ratio -1
set xrange [-97:97]; set yrange [-97:97]
set parametric; set trange [0:2*pi]
set datafile missing '?'  # an image needs all its pixels; those below the horizon are nan
set cbtics font ',12' scale 0.5
side = 150.0; across = 160.0; down = 170.0
element(k) = k == 0 ? column('f00') : column(sprintf('f%d%d', k / 4, k % 4)) / column('f00')
set multiplot
do for [k = 0:15] {
  left = 60 + (k % 4) * across
  top = 26 + (k / 4) * down
  set lmargin at screen left / width; set rmargin at screen (left + side) / width
  set tmargin at screen 1 - top / height; set bmargin at screen 1 - (top + side) / height
  set title sprintf('f_{%d%d}', k / 4, k % 4) . (k == 0 ? '' : ' / f_{00}') offset 0,-0.9
  if (k == 0) {
    @level_map; set cbrange [0:*]
    set colorbox user origin screen 6.0 / width, 1 - (top + side - 10) / height size screen 9.0 / width, (side - 20) / height
    set cbtics offset -0.6,0 0.5
  } else {
    @signed_map; set cbrange [-1:1]
    set colorbox user origin screen (60 + 4 * across) / width, 0.25 size screen 12.0 / width, 0.5
    set cbtics offset -0.5,0 0.5
    if (k < 15) { unset colorbox }
  }
  plot 'matrix.csv' using 'x_deg':'y_deg':(element(k)) with image, \
       90*cos(t),90*sin(t) with lines linecolor rgb '#808080' linewidth 1 dashtype solid, \
       '+' using (-45):(0) every ::0::0 with points pointtype 7 pointsize 0.6 linecolor rgb (k == 0 ? '#ffffff' : '#333333'), \
       '+' using (45):(0) every ::0::0 with points pointtype 1 pointsize 1 linewidth 1.5 linecolor rgb (k == 0 ? '#ffffff' : '#333333')
}
unset multiplot
