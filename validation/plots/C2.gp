# Errors of prediction against the degree of polarisation; 1 % is the tolerance of sec 7.1.2.2.
width = 760; height = 460
load style
set xlabel 'DoP of the irradiance [%]'
set ylabel 'error [%]'
set yrange [-2.5:14]; set ytics 2
set key top left Left reverse font ',13'
plot 1 with lines linestyle 12 title '1 %, the tolerance', \
     'thresholds.csv' using 'DoP':'s1_unpolarized' with lines linetype 1 title '1 % sensor, unpolarised', \
     '' using 'DoP':'s1_polarized' with lines linetype 6 title '1 % sensor, polarised', \
     '' using 'DoP':'s5_unpolarized' with lines linetype 2 title '5 % sensor, unpolarised', \
     '' using 'DoP':'s5_polarized' with lines linetype 5 title '5 % sensor, polarised', \
     '' using 'DoP':'s5_eq716_unpolarized' with lines linetype 7 title '5 %, unpolarised, row (1, s, s, s)', \
     '' using 'DoP':'s5_eq716_polarized' with lines linetype 4 title '5 %, polarised, row (1, s, s, s)'
