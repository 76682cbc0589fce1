# Tables 7.3 and 7.4: detected radiance, both sensor rows, as printed and mended, and the residual.
width = 720; height = 560
load style
set multiplot
set lmargin 12; set rmargin 3
set origin 0,0.34; set size 1,0.66
set ylabel "L_0 [W m^{-2} sr^{-1}]"
set format x ''
set key top left Left reverse samplen 2 font ',13'
set yrange [*:*<200]; set offsets 0, 0, graph 0.3, 0
plot 'detected.csv' using 'DoP':'detected_L0' with lines linetype 1 title 'detected, row (1, s, 0, -s)', \
     '' using 'DoP':'detected_eq716_L0' with lines linetype 2 title 'detected, row (1, s, s, s)', \
     '' using 'DoP':'polarized_L0' with lines linetype 3 title 'reaching, polarised', \
     '' using 'DoP':'unpolarized_L0' with lines linetype 7 title 'unpolarised', \
     '' using 'DoP':'printed_L0' with points linestyle 11 title 'detected, as printed', \
     '' using 'DoP':'mended_L0' with points linetype 1 pointsize 0.5 title 'mended by its error columns'
set origin 0,0; set size 1,0.36
set format x '%g'; set xlabel 'DoP of the irradiance'
set ylabel 'residual'
set offsets 0, 0, 0, 0; set yrange [-0.01:0.01]; set ytics 0.01
plot 0.005 with lines linestyle 12, -0.005 with lines linestyle 12, \
     'detected.csv' using 'DoP':(column('detected_L0')-column('mended_L0')) with points linetype 1 pointsize 0.7
unset multiplot
