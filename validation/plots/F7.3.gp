# Figure 7.3: cuts of Priest and Germer's figures 5 and 6, and what the thesis's additions change.
width = 760; height = 760
load style
set multiplot
set lmargin 11; set rmargin 20
set key outside right center Left reverse samplen 2
element(e) = 'f_{' . e[2:3] . '}'
set ylabel 'element [sr^{-1}]'
set origin 0,0.66; set size 1,0.34
set xrange [0:90]; set xtics 15; set yrange [-0.1:1]; set ytics 0.25; set xlabel 'view zenith in the plane of incidence [deg]'
plot for [e in 'f00 f10 f11 f22 f33'] 'in_plane.csv' using 'view_deg':e with lines linewidth (e eq 'f00' ? 5 : 2) linetype (e eq 'f00' ? 1 : e eq 'f10' ? 2 : e eq 'f20' ? 3 : e eq 'f11' ? 4 : e eq 'f22' ? 5 : 6) title element(e)
set origin 0,0.33; set size 1,0.34
set xrange [0:180]; set xtics 30; set yrange [-0.02:0.18]; set ytics 0.05; set xlabel 'view azimuth at view zenith 65 deg [deg]'
plot for [e in 'f00 f10 f20 f11 f22 f33'] 'around.csv' using 'phi_deg':e with lines linewidth (e eq 'f00' ? 5 : 2) linetype (e eq 'f00' ? 1 : e eq 'f10' ? 2 : e eq 'f20' ? 3 : e eq 'f11' ? 4 : e eq 'f22' ? 5 : 6) title element(e)
set origin 0,0; set size 1,0.34
set ylabel 'DoLP'; set yrange [0:1]; set ytics 0.25

plot 'around.csv' using 'phi_deg':'dolp_facets' with lines linetype 1 title 'facets', \
     '' using 'phi_deg':'dolp_thesis' with lines linetype 2 title 'and diffuse'
unset multiplot
