# Figure 5.5: a synthetic scan (line), the modified Cauchy distribution fitted to it (dashes), and the difference.
width = 840; height = 400
load style
set multiplot
set lmargin 11; set rmargin 3
set xrange [0:80]; set xtics 20; set xlabel 'tilt of the facets [deg]'
set arrow from 20, graph 0 to 20, graph 1 nohead linestyle 12
set origin 0,0; set size 0.5,1
set ylabel 'first surface BRDF [sr^{-1}]'; set yrange [0:*]; set title '(a) scan and fit'
plot 'scan.csv' using 'tilt_deg':'scan_per_sr' with lines title 'scan', \
     '' using 'tilt_deg':'fit_per_sr' with lines title 'modified Cauchy'
set origin 0.5,0; set size 0.5,1
set ylabel 'fit minus scan [sr^{-1}]'; set yrange [*:*]; set title '(b) difference'
plot 0 linestyle 12, 'scan.csv' using 'tilt_deg':'difference_per_sr' with lines linetype 1
unset multiplot
