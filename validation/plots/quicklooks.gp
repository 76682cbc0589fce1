# X.sky: the PNG quicklooks of a cube as they are (quick.S0.png and so on).
width = 800; height = 366
load style
unset border; unset tics; unset grid; set key off
set size ratio -1
set multiplot
names = 'S0 S1 S2 S3 DoLP AoLP'
titles = 'S_0 S_1 S_2 S_3 DoLP AoLP'
do for [i = 0:5] {
  left = 8 + 264 * (i % 3); top = 26 + 182 * (i / 3)
  set lmargin at screen real(left) / width; set rmargin at screen (left + 256.0) / width
  set tmargin at screen 1 - real(top) / height; set bmargin at screen 1 - (top + 151.0) / height
  set title word(titles, i + 1) offset 0,-0.8
  plot 'quick.' . word(names, i + 1) . '.png' binary filetype=png with rgbimage
}
unset multiplot
