# Figure 7.6: shift and width of the specular lobe.
width = 840; height = 420
load style
of(p, v, c) = abs(column(p) - v) < 1e-6 ? column(c) : NaN
clipped(v) = abs(column('sigma') - v) < 1e-6 && column('clipped') > 0 ? column('fwhm_deg') : NaN
set multiplot
set xrange [0:80]; set xtics 20; set xlabel 'zenith of incidence [deg]'
set lmargin 11; set rmargin 3
unset key
set origin 0,0; set size 0.5,1
set ylabel 'peak minus mirror direction [deg]'
plot for [i=1:5] 'lobes.csv' using 'theta_i_deg':(of('sigma', word('0.05 0.1 0.15 0.2 0.3', i)+0, 'shift_deg')) with lines linetype i title word('0.05 0.1 0.15 0.2 0.3', i)
set origin 0.5,0; set size 0.5,1
set ylabel 'full width at half maximum [deg]'
set key top right Left reverse title 'σ' samplen 2
plot for [i=1:5] 'lobes.csv' using 'theta_i_deg':(of('sigma', word('0.05 0.1 0.15 0.2 0.3', i)+0, 'fwhm_deg')) with lines linetype i title word('0.05 0.1 0.15 0.2 0.3', i), \
     for [i=1:5] '' using 'theta_i_deg':(clipped(word('0.05 0.1 0.15 0.2 0.3', i)+0)) with points linestyle 11 notitle
unset multiplot
