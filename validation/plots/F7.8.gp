# Figure 7.8: in-plane f00 and f23 against k.
width = 840; height = 400
load style
of(p, v, c) = abs(column(p) - v) < 1e-6 ? column(c) : NaN
set multiplot
set xrange [-90:90]; set xtics 30; set xlabel 'view zenith [deg]'
set lmargin 11; set rmargin 3
set key top left Left reverse title 'k' samplen 2
set origin 0,0; set size 0.5,1
set ylabel 'f_{00} [sr^{-1}]'
plot for [s in '0 0.5 1 2 4'] 'lobes.csv' using 'view_deg':(of('k', s+0, 'f00')) with lines title s
set origin 0.5,0; set size 0.5,1
set ylabel 'f_{23} [sr^{-1}]'
plot for [s in '0 0.5 1 2 4'] 'lobes.csv' using 'view_deg':(of('k', s+0, 'f23')) with lines title s
unset multiplot
