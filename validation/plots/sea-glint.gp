# X.glint: the sea seen straight down by a fisheye camera, radiance above and DoLP below (glint.csv); the sun is upwards.
width = 900; height = 590
load style
unset border; unset tics; unset grid; set key off
set size ratio -1
set xrange [-86:86]; set yrange [-86:86]
set parametric; set trange [0:2*pi]
set datafile missing '?'  # an image needs all its pixels; those outside of the dome are nan
set cbtics font ',11' scale 0.5
array Name[3]; Name[1] = 'sea'; Name[2] = 'plane'; Name[3] = 'space'
array Title[3]; Title[1] = 'at the surface, no air'; Title[2] = 'from 3 km, haze'; Title[3] = 'from space, haze'
@level_map
set multiplot
do for [i = 1:6] {
  column_ = (i - 1) % 3; row_ = (i - 1) / 3; k = column_ + 1
  set lmargin at screen column_ * 0.295 + 0.01
  set rmargin at screen column_ * 0.295 + 0.285
  set tmargin at screen 0.94 - row_ * 0.49
  set bmargin at screen 0.50 - row_ * 0.49
  if (row_ == 0) { set title Title[k] offset 0,-0.6; set logscale cb; set cbrange [1e-3:1]; set format cb '10^{%L}'; data = Name[k] } \
  else { unset title; unset logscale cb; set cbrange [0:1]; set format cb '%g'; data = Name[k] . '_dolp' }
  if (k == 3) { set colorbox user origin screen 0.895, 0.58 - row_ * 0.49 size screen 0.012, 0.30 } else { unset colorbox }
  set cblabel (row_ == 0 ? 'radiance / irradiance [1/sr]' : 'DoLP') font ',11'
  plot 'glint.csv' using 'x':'y':(column(data)) with image, \
       84*cos(t),84*sin(t) with lines linecolor rgb '#808080' linewidth 1 dashtype solid
}
unset multiplot
