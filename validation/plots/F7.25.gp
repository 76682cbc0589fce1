# F7.25: the two flights seen from the south (cameras.csv): places, lines of sight, the sun in the west.
width = 760
height = 400
load style
set size ratio -1
set xrange [-20:20]
set yrange [0:20]
set xlabel 'east [m]'
set ylabel 'height [m]'
set key top right
do for [i = 0:1] {
  x = -2 + 4 * i
  set object 1 + i polygon from x-1.5,0 to x+1.5,0 to x+0.75,1 to x-0.75,1 to x-1.5,0 fillcolor rgb '#b8b8b8' fillstyle solid
}
set arrow 1 from -19.5,12.0 to -3.5,2.76 linecolor rgb '#e69f00' linewidth 2
set label 1 'sun' at -19.3,13.0 left textcolor rgb '#b07800'
plot 'cameras.csv' using 'x_m':'z_m':(column('flight') == 1 ? 4 * column('look_x') : NaN):(4 * column('look_z')) with vectors linetype 2 dashtype solid notitle, \
     'cameras.csv' using 'x_m':'z_m':(column('flight') == 0 ? 0 : NaN):(4 * column('look_z')) with vectors linetype 1 notitle, \
     'cameras.csv' using 'x_m':(column('flight') == 0 ? column('z_m') : NaN) with points linetype 1 title 'straight down', \
     'cameras.csv' using 'x_m':(column('flight') == 1 ? column('z_m') : NaN) with points linetype 2 pointtype 4 pointsize 2 title 'staring'
