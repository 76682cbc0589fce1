# X.measured: the lobe of rough glass against the viewer's angle (left) and the tilt of the facet that reflects (right).
width = 1000; height = 420
load style
of(i, c) = column('theta_i_deg') == i ? column(c) : NaN
set multiplot
set lmargin 9; set rmargin 3; set bmargin 4.5; set tmargin 1.5
set yrange [0:1.15]; set ytics 0.5
set ylabel 'share of the peak'
set format x '%g°'
set origin 0,0; set size 0.5,1
set xrange [-90:90]; set xtics 30; set xlabel 'zenith angle of the viewer, the mirror side positive'
set key top left samplen 2 title 'source at'
plot for [i in '0 30 60'] 'peaks.csv' using 'theta_r_deg':(of(real(i), 'share_of_peak')) with lines title i.'°'
set origin 0.5,0; set size 0.5,1
set xrange [-45:45]; set xtics 15; set xlabel 'tilt of the facet that reflects, θ_h'
unset key
plot for [i in '0 30 60'] 'peaks.csv' using 'tilt_deg':(of(real(i), 'share_of_peak')) with lines
unset multiplot
