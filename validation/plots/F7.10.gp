# Figure 7.10: in-plane DoLP of aluminium for a family of incidences, and its near-normal part enlarged.
width = 840; height = 420
load style
of(p, v, c) = abs(column(p) - v) < 1e-6 ? column(c) : NaN
set multiplot
set xrange [0:90]; set xtics 15; set xlabel 'view zenith [deg]'
set lmargin 11; set rmargin 3
set key top left Left reverse title 'incidence [deg]' samplen 2
set origin 0,0; set size 0.5,1
set ylabel 'DoLP'
plot for [s in '5 10 20 30 45 60 75'] 'dolp.csv' using 'view_deg':(of('theta_i_deg', s+0, 'dolp')) with lines title s
set origin 0.5,0; set size 0.5,1
set yrange [0:0.04]
set object 1 rectangle from 60, graph 0 to 70, graph 1 fillcolor rgb '#eeeeee' fillstyle solid noborder behind
plot for [s in '2.5 5 10 20'] 'dolp.csv' using 'view_deg':(of('theta_i_deg', s+0, 'dolp')) with lines linetype (s eq '2.5' ? 8 : s eq '5' ? 1 : s eq '10' ? 2 : 3) title s
unset multiplot
