# Figure 5.6: directions of the DHR sum; dots of the half that symmetry makes superfluous are open.
width = 560; height = 600
load style
set size ratio -1
unset border; unset tics; unset grid
set xrange [-95:95]; set yrange [-95:95]
set angles degrees
set parametric; set trange [0:360]
set label '30°' at 30*cos(60), 30*sin(60) center front boxed
set label '60°' at 60*cos(60), 60*sin(60) center front boxed
set label '90°' at 90*cos(60), 90*sin(60) center front boxed
set object circle at 20, 0 size 3.5 front fillstyle solid 1 border rgb '#333333' fillcolor rgb '#f0e442'
set style textbox opaque noborder fillcolor rgb '#ffffff' margins 0.4,0.4
set label 'light' at 25, 0 left front boxed
set key outside bottom center horizontal
plot for [r in '30 60 90'] r*cos(t), r*sin(t) with lines linestyle 12, \
     'grid.csv' using 'x_deg':(column('kept') > 0 ? column('y_deg') : NaN) with points pointtype 7 pointsize 0.35 linecolor rgb '#0072b2' notitle, \
     '' using 'x_deg':(column('kept') > 0 ? NaN : column('y_deg')) with points pointtype 6 pointsize 0.45 linecolor rgb '#d55e00' notitle, \
     '+' using (NaN):(NaN) with points pointtype 7 pointsize 1 linecolor rgb '#0072b2' title 'kept', \
     '+' using (NaN):(NaN) with points pointtype 6 pointsize 1 linecolor rgb '#d55e00' title 'superfluous'
