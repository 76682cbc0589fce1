# Figure 7.7: in-plane f00 against n, two roughnesses.
width = 840; height = 400
load style
of(p, v, c) = abs(column(p) - v) < 1e-6 ? column(c) : NaN
set multiplot
set xrange [-90:90]; set xtics 30; set xlabel 'view zenith [deg]'
set lmargin 11; set rmargin 3
set key top left Left reverse title 'n' samplen 2
set origin 0,0; set size 0.5,1
set ylabel 'f_{00} [sr^{-1}]'; set title '(a) σ = 0.1'
plot for [s in '1.3 1.5 1.7 1.9'] 'sigma01.csv' using 'view_deg':(of('n', s+0, 'f00')) with lines title s
set origin 0.5,0; set size 0.5,1
set title '(b) σ = 0.2'
plot for [s in '1.3 1.5 1.7 1.9'] 'sigma02.csv' using 'view_deg':(of('n', s+0, 'f00')) with lines title s
unset multiplot
