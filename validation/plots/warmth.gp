# X.thermal: temperatures of the bar of copper and paint through a day (warmth.csv).
width = 760
load style
set xrange [0:24]; set xtics 6
set format x '%g:00'
set ylabel 'temperature [K]'
set key outside right top
plot 'warmth.csv' using 'hour':'east' with lines linetype 1 title 'paint, east', \
     '' using 'hour':'south' with lines linetype 2 title 'paint, south', \
     '' using 'hour':'west' with lines linetype 3 title 'paint, west', \
     '' using 'hour':'north' with lines linetype 4 title 'paint, north', \
     '' using 'hour':'top' with lines linetype 5 title 'paint, top', \
     '' using 'hour':'copper' with lines linetype 6 title 'copper, top', \
     '' using 'hour':'soil' with lines linetype 7 title 'soil', \
     '' using 'hour':'air' with lines linestyle 12 title 'air'
