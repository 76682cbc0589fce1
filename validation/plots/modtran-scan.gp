# X.modtran: DoLP against the angle from the sun, 700 nm, 3.4 km, one ingredient after the other (modtran-scan.csv).
width = 900; height = 400
load style
set xlabel 'angle from the sun [deg]'; set ylabel 'DoLP'
set multiplot
set tmargin at screen 0.95; set bmargin at screen 0.18
set lmargin at screen 0.11; set rmargin at screen 0.43
set xrange [0:150]; set xtics 30; set yrange [0:1]; set key off
plot for [i = 2:7] 'modtran-scan.csv' using 1:i with lines
set lmargin at screen 0.51; set rmargin at screen 0.80
set xrange [75:105]; set xtics 10; set yrange [0.65:1.0]; set ytics 0.1
unset ylabel
set key at screen 0.995,0.90 right top Left reverse
plot 'modtran-scan.csv' using 'angle_deg':'round' with lines title 'round', \
     '' using 'angle_deg':'molecules' with lines title 'molecules', \
     '' using 'angle_deg':'multiple' with lines title 'multiple', \
     '' using 'angle_deg':'ground' with lines title 'ground', \
     '' using 'angle_deg':'aerosol' with lines title 'aerosol', \
     '' using 'angle_deg':'ozone' with lines title 'ozone'
unset multiplot
