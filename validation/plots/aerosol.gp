# X.aerosol: polarisation along the sun's meridian (meridian.csv) and the neutral points (points.csv) of hazy skies.
width = 900; height = 400
load style
set multiplot
set lmargin at screen 0.08; set rmargin at screen 0.50
set tmargin at screen 0.9; set bmargin at screen 0.2
set title 'S_1 / S_0  in the sun''s meridian' offset 0,-0.5
set xrange [-90:90]; set xtics -90,30,90; set yrange [-0.2:1]; set ytics -0.2,0.2,1
set xlabel 'zenith angle [deg]; the sun at 80'
set arrow 1 from -90,0 to 90,0 nohead ls 12
set arrow 2 from 80,-0.2 to 80,1 nohead ls 12
set key at graph 0.93,0.98 top right samplen 2
plot 'meridian.csv' using 'zenith_deg':'clear' with lines title 'clear air', \
     '' using 'zenith_deg':'haze_0.1' with lines title 'haze 0.1', \
     '' using 'zenith_deg':'haze_0.3' with lines title 'haze 0.3'
unset arrow
set lmargin at screen 0.60; set rmargin at screen 0.97
set title 'neutral points' offset 0,-0.5
set xrange [0:0.6]; set xtics 0,0.1,0.6; set yrange [0:40]; set ytics 0,10,40
set xlabel 'optical depth of the haze'; set ylabel 'distance [deg]'
set label 1 'Arago, from the antisolar point' at 0.59,37 right textcolor rgb ink
set label 2 'Babinet, from the sun' at 0.59,20.5 right textcolor rgb ink
set key bottom right
plot 'points.csv' using 'haze':'arago_deg' with lines lt 7 dt 1 title 'spheres', \
     '' using 'haze':'spheroids_arago_deg' with lines lt 7 dt 2 title 'spheroids', \
     '' using 'haze':'babinet_deg' with lines lt 4 dt 1, \
     '' using 'haze':'spheroids_babinet_deg' with lines lt 4 dt 2
unset multiplot
