# Figure 6.3: directions of the adaptive sampling, seen from above; the distance from the centre is the
# zenith angle (points.csv; step 0 the first 24, 1 the first division, 2 the later ones).
width = 720
height = 560
load style
unset border
unset tics
unset grid
set size ratio -1
set xrange [-98:98]
set yrange [-98:98]
set lmargin 1
set rmargin 1
set tmargin 0.5
set bmargin 0.5
set key outside right top width -2
set parametric
set trange [0:2*pi]
do for [k=0:15] { set arrow k+1 from 0,0 to 90*cos(k*pi/8),90*sin(k*pi/8) nohead linecolor rgb '#c8c8c8' linewidth 0.8 }
do for [k=1:6] { set label k sprintf('%d°', 15*k) at 15*k*cos(-3*pi/16),15*k*sin(-3*pi/16) center font ',10' textcolor rgb '#808080' }
x(step) = column('step') == step ? column('zenith_deg')*cos(column('azimuth_deg')*pi/180) : NaN
y(step) = column('zenith_deg')*sin(column('azimuth_deg')*pi/180)
plot for [k=1:6] 15*k*cos(t),15*k*sin(t) with lines linecolor rgb (k == 6 ? '#808080' : '#c8c8c8') linewidth (k == 6 ? 1.2 : 0.8) dashtype solid notitle, \
     'points.csv' using (x(0)):(y(0)) with points pointtype 7 pointsize 1.3 linecolor rgb '#9a9a9a' title 'first 24', \
     'points.csv' using (x(1)):(y(1)) with points pointtype 13 pointsize 1.3 linecolor rgb '#000000' title 'next 8', \
     'points.csv' using (x(2)):(y(2)) with points pointtype 7 pointsize 0.35 linecolor rgb '#0072b2' title 'later', \
     '+' using (-40):(0) every ::0::0 with points pointtype 1 pointsize 1.6 linewidth 2 linecolor rgb '#d55e00' title 'mirror'
