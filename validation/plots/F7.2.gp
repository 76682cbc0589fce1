# Figure 7.2: degree of polarisation of a smooth dielectric, Fresnel against Torrance-Sparrow.
height = 480
load style
set multiplot
set lmargin 12; set rmargin 3
set xrange [0:90]; set xtics 15
set yrange [0:1.05]; set ytics 0.25
set origin 0,0.36; set size 1,0.64
set ylabel 'degree of polarisation'
set format x ''
set key at graph 0.96, graph 0.22 font ',13' width -2
plot 'dop.csv' using 'zenith_deg':'fresnel' with lines linetype 1 title 'Fresnel, n = 2', \
     '' using 'zenith_deg':'torrance_sparrow' every 6 with points linetype 2 pointsize 0.6 title 'Torrance-Sparrow, σ = 0.05'
set yrange [*:*]
set origin 0,0; set size 1,0.38
set format x '%g'; set xlabel 'zenith of incidence and view [deg]'
set ylabel "residual\n[10^{-5}]"
set ytics 2
unset key
plot 0 with lines linestyle 12, 'dop.csv' using 'zenith_deg':(1e5*column('residual')) with lines linetype 2
unset multiplot
