# X.thermal: brightness temperature of a clear summer sky at 10 um over the zenith angle (glow.csv).
width = 760
load style
set xrange [0:90]; set xtics 15
set format x '%g°'
set xlabel 'zenith angle'
set ylabel 'brightness temperature [K]'
set key outside right top
plot 'glow.csv' using 'zenith_deg':'depth3' with lines linetype 4 title 'optical depth 3', \
     '' using 'zenith_deg':'depth1' with lines linetype 3 title '1', \
     '' using 'zenith_deg':'depth03' with lines linetype 2 title '0.3', \
     '' using 'zenith_deg':'depth01' with lines linetype 1 title '0.1'
