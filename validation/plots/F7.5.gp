# Figure 7.5: f10 and f20 against azimuth.
width = 840; height = 400
load style
of(p, v, c) = abs(column(p) - v) < 1e-6 ? column(c) : NaN
set multiplot
set xrange [90:270]; set xtics 45; set xlabel 'view azimuth [deg]'
set key top right Left reverse title 'σ' samplen 2
set lmargin 11; set rmargin 3
set origin 0,0; set size 0.5,1
set ylabel 'f_{10} [sr^{-1}]'
plot for [s in '0.1 0.15 0.2 0.3'] 'around.csv' using 'phi_deg':(of('sigma', s+0, 'f10')) with lines title s
set origin 0.5,0; set size 0.5,1
set ylabel 'f_{20} [sr^{-1}]'
plot 0 with lines linestyle 12 notitle, for [s in '0.1 0.15 0.2 0.3'] 'around.csv' using 'phi_deg':(of('sigma', s+0, 'f20')) with lines linetype (s eq '0.1' ? 1 : s eq '0.15' ? 2 : s eq '0.2' ? 3 : 4) title s
unset multiplot
