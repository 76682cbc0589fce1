# Figure 7.39: the suns of the day on a dome over the scene (hours.csv, path.csv), the camera above it.
width = 800; height = 430
load style
unset border; unset tics; unset grid
set view 72, 12, 2.7, 1
set view equal xyz
set xyplane at 0
set xrange [-1.1:1.1]; set yrange [-1.1:1.1]; set zrange [0:1.15]
set parametric
set urange [0:2*pi]; set vrange [0:1]
set lmargin 0; set rmargin 0; set tmargin 0; set bmargin 0
set label 1 'E' at 1.12,0,0 center; set label 2 'N' at 0,1.12,0 center
set label 3 'W' at -1.12,0,0 center; set label 4 'S' at 0,-1.12,0 center
# the scene: four blocks and the camera that looks down on them
block(n, x, y) = sprintf('set object %d polygon from %f,%f,0 to %f,%f,0 to %f,%f,0 to %f,%f,0 to %f,%f,0 fillstyle solid 0.7 border', \
  n, x-.05,y-.05, x+.05,y-.05, x+.05,y+.05, x-.05,y+.05, x-.05,y-.05)
eval block(1,-.07,-.07); eval block(2,.07,-.07); eval block(3,-.07,.07); eval block(4,.07,.07)
do for [k=1:4] { set object k fillcolor rgb '#b87333' }
do for [k=0:3] { set arrow k+1 from 0,0,0.62 to (k%2?.16:-.16),(k/2?.16:-.16),0 nohead linecolor rgb '#808080' linewidth 0.8 dashtype (4,3) }
set label 5 'camera' at 0.05,0,0.67
set key off
splot cos(u),sin(u),0 with lines linecolor rgb '#808080' linewidth 1 dashtype solid, \
      'path.csv' using 'x':'y':'z' with lines linecolor rgb '#e69f00' linewidth 2 dashtype solid, \
      'hours.csv' using 'x':'y':'z' with impulses linecolor rgb '#d8d8d8' linewidth 0.8 dashtype solid, \
      'hours.csv' using 'x':'y':'z' with points pointtype 7 pointsize 2.2 linecolor rgb '#e69f00', \
      'hours.csv' using (column('x')*1.09):(column('y')*1.09):(column('z')*1.09+0.02):(sprintf('%d', column('hour'))) with labels font ',11', \
      '+' using (0):(0):(0.62) every ::0::0 with points pointtype 5 pointsize 1.6 linecolor rgb '#333333'
