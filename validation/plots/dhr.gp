# X.DHR: DHR of perfectly reflecting facets against zenith angle (dhr.csv).
load style
set xrange [0:90]
set yrange [0.3:1.2]
set xtics 15
set format x '%g°'
set xlabel 'zenith angle'
set ylabel 'DHR'
set key bottom right
plot 1 linestyle 12, \
     'dhr.csv' using 'zenith_deg':'sigma0.05' with lines linetype 1 title 'σ = 0.05', \
     'dhr.csv' using 'zenith_deg':'sigma0.1' with lines linetype 2 title '0.1', \
     'dhr.csv' using 'zenith_deg':'sigma0.2' with lines linetype 3 title '0.2', \
     'dhr.csv' using 'zenith_deg':'smith0.2' with lines linetype 6 title '0.2, Smith', \
     'dhr.csv' using 'zenith_deg':'none0.2' with lines linetype 7 title '0.2, no shadowing', \
     'dhr.csv' using 'zenith_deg':'sigma0.4' with lines linetype 4 title '0.4', \
     'dhr.csv' using 'zenith_deg':'sigma0.6' with lines linetype 5 title '0.6'
