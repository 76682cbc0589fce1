# X.emission: DoLP and amount of emitted light over the zenith angle (dolp.csv, emissivity.csv).
width = 900; height = 420
load style
stats 'dolp.csv' using 1 skip 1 nooutput
curves = STATS_columns
set multiplot layout 1,2
set xrange [0:90]; set xtics 15
set format x '%g°'
set xlabel 'zenith angle'
set yrange [0:1]
unset key
set title 'degree of linear polarisation'
plot for [i=2:curves] 'dolp.csv' using 1:i with lines linetype i-1 title columnheader(i)
set key at graph 0.05, 0.62 left top Left reverse samplen 3
set title 'emissivity'
plot for [i=2:curves] 'emissivity.csv' using 1:i with lines linetype i-1 title columnheader(i)
unset multiplot
