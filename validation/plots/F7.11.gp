# Figure 7.11: out-of-plane DoLP of aluminium, near-normal and oblique incidence.
width = 840; height = 420
load style
of(p, v, c) = abs(column(p) - v) < 1e-6 ? column(c) : NaN
set multiplot
set xrange [0:360]; set xtics 90; set xlabel 'view azimuth [deg]'
set lmargin 11; set rmargin 3
set key top left Left reverse title 'view [deg]' samplen 2
set origin 0,0; set size 0.5,1
set ylabel 'DoLP'; set title '(a) incidence 5 deg'
set yrange [0:0.03]
plot for [s in '15 30 45 60 75 85'] 'near_normal.csv' using 'phi_deg':(of('view_deg', s+0, 'dolp')) with lines title s
set origin 0.5,0; set size 0.5,1
set title '(b) incidence 60 deg'; set yrange [0:0.16]
plot for [s in '15 30 45 60 75 85'] 'oblique.csv' using 'phi_deg':(of('view_deg', s+0, 'dolp')) with lines title s
unset multiplot
