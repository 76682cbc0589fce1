# Figure 7.4: in-plane f00 of aluminium, smooth and rough.
width = 840; height = 400
load style
of(p, v, c) = abs(column(p) - v) < 1e-6 ? column(c) : NaN
set multiplot
set xrange [-30:90]; set xtics 30; set xlabel 'view zenith [deg]'
set key top left Left reverse title 'σ' samplen 2
set lmargin 11; set rmargin 3
set origin 0,0; set size 0.5,1
set ylabel 'f_{00} [sr^{-1}]'; set title '(a) smooth'
set yrange [0:30]
plot for [s in '0.05 0.1 0.15'] 'lobes.csv' using 'view_deg':(of('sigma', s+0, 'f00')) with lines title s
set origin 0.5,0; set size 0.5,1
set title '(b) rough'; set yrange [0:2.5]
set arrow from 75, graph 0 to 75, graph 1 nohead linestyle 12
plot for [s in '0.2 0.3 0.4 0.5'] 'lobes.csv' using 'view_deg':(of('sigma', s+0, 'f00')) with lines title s
unset multiplot
