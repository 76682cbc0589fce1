# X.sky: the positions of the neutral points (neutral.csv).
load style
set xrange [0:62]; set yrange [0:30]
set xlabel 'elevation of the sun [deg]'; set ylabel 'distance [deg]'
set key bottom left Left reverse
plot 'neutral.csv' using 'sun_elevation_deg':'babinet_deg' with lines title 'Babinet, above the sun', \
     'neutral.csv' using 'sun_elevation_deg':'brewster_deg' with lines title 'Brewster, below the sun', \
     'neutral.csv' using 'sun_elevation_deg':'arago_deg' with lines title 'Arago, above the antisolar point'
