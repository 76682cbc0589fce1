# X.thermal: emitted and reflected polarised light of the bar's sides through a day (balance.csv).
width = 960; height = 420
load style
set multiplot layout 1,2
set xrange [0:24]; set xtics 6
set format x '%g:00'
set ylabel 'S_1 / S_0, s above zero'
set yrange [-0.25:0.15]
set key bottom center vertical
set title 'paint, east side'
plot 0 with lines linestyle 12, \
     'balance.csv' using 'hour':'emitted' with lines linetype 2 title 'emitted', \
     '' using 'hour':'reflected' with lines linetype 3 title 'reflected', \
     '' using 'hour':'sum' with lines linetype 1 title 'sum'
set title 'sums: four sides of paint, one of copper'
unset ylabel
set yrange [-0.05:0.03]
set key bottom center horizontal maxrows 3
plot 0 with lines linestyle 12, \
     'balance.csv' using 'hour':'sum' with lines linetype 1 title 'east', \
     '' using 'hour':'south' with lines linetype 2 title 'south', \
     '' using 'hour':'west' with lines linetype 3 title 'west', \
     '' using 'hour':'north' with lines linetype 4 title 'north', \
     '' using 'hour':'copper' with lines linetype 6 title 'copper, east'
unset multiplot
