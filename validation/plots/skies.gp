# X.iprt: degree of polarisation of six skies (skies.csv) with their neutral points (skies-neutral.csv).
width = 880; height = 590
load style
unset border; unset tics; unset grid; set key off
set size ratio -1
set xrange [-94:94]; set yrange [-94:94]
set parametric; set trange [0:2*pi]
set datafile missing '?'  # an image needs all its pixels; those outside of the dome are nan
set cbtics font ',11' scale 0.5
array Name[6]; Name[1] = 'clear'; Name[2] = 'sea'; Name[3] = 'snow'; Name[4] = 'haze'; Name[5] = 'dust'; Name[6] = 'cloud'
array Title[6]; Title[1] = 'clear air'; Title[2] = 'over the sea'; Title[3] = 'over snow'; Title[4] = 'with haze'; Title[5] = 'with dust'; Title[6] = 'with a thin cloud'
@level_map
set cbrange [0:0.8]
set multiplot
do for [i = 1:6] {
  column_ = (i - 1) % 3; row_ = (i - 1) / 3
  set lmargin at screen column_ * 0.305 + 0.01
  set rmargin at screen column_ * 0.305 + 0.295
  set tmargin at screen 0.94 - row_ * 0.5
  set bmargin at screen 0.52 - row_ * 0.5
  set title Title[i] offset 0,-0.6
  if (i == 6) { set colorbox user origin screen 0.935, 0.2 size screen 0.012, 0.6 } else { unset colorbox }
  plot 'skies.csv' using 'x':'y':(column(Name[i])) with image, \
       90*cos(t),90*sin(t) with lines linecolor rgb '#808080' linewidth 1 dashtype solid, \
       'skies-neutral.csv' using (strcol('sky') eq Name[i] ? column('x') : NaN):'y' with points pointtype 6 pointsize 0.8 linewidth 1.5 linecolor rgb '#ffffff', \
       '+' using (0):(-65) every ::::0 with points pointtype 1 pointsize 1 linewidth 1.5 linecolor rgb '#ffffff'
}
unset multiplot
