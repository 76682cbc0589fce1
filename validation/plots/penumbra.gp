# X.sun: light on the ground across the edge of a shadow, ten metres below the roof (penumbra.csv).
width = 760
load style
set xlabel 'distance from the edge, cm'
set ylabel 'light / unhindered light'
set xrange [-7:7]
set yrange [-0.05:1.05]
set key left top
plot 'penumbra.csv' using 'x_cm':'exact' with lines linetype 1 title 'segment of a circle', \
     '' using 'x_cm':'samples_16' with points linetype 2 title '16 samples', \
     '' using 'x_cm':'samples_4096' with points linetype 3 title '4096 samples'
