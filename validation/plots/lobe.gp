# X.basis: copper and sums of three orders: f00 (left), smallest eigenvalue of the matrix over f00 (right).
width = 1000; height = 440
load style
of(o, c) = column('order') == o ? column(c) : NaN
name(o) = o == 0 ? 'copper' : sprintf('order %d', o)
set multiplot
set lmargin 10; set rmargin 3; set bmargin 4.5; set tmargin 1.5
set format x '%g°'; set xrange [-90:90]; set xtics 30
set xlabel 'zenith angle of the viewer'
set origin 0,0; set size 0.5,1
set ylabel 'f_{00} [sr^{-1}]'; set yrange [0:*]
set key top left samplen 2
plot for [o in '0 2 4 10'] 'lobe.csv' using 'theta_r_deg':(of(int(o), 'f00_per_sr')) with lines title name(int(o))
set origin 0.5,0; set size 0.5,1
unset key
set ylabel 'smallest eigenvalue / f_{00}'; set yrange [-0.6:0.4]
plot 0 with lines linestyle 12, for [o in '0 2 4 10'] 'lobe.csv' using 'theta_r_deg':(of(int(o), 'least_over_f00')) with lines linetype (o eq '0' ? 1 : o eq '2' ? 2 : o eq '4' ? 3 : 4)
unset multiplot
