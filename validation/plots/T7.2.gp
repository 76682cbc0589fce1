# Table 7.2: radiance against DoLP, ours and as printed, and the residual.
height = 480
load style
set multiplot
set lmargin 12; set rmargin 2
set origin 0,0.36; set size 1,0.64
set ylabel "L_0 [W m^{-2} sr^{-1}]"
set format x ''
set key top left
plot 'sensor_reaching.csv' using 'DoLP':'L0' with lines linetype 1 title 'ours', \
     '' using 'DoLP':'printed' with points linestyle 11 title 'table 7.2'
set origin 0,0; set size 1,0.38
set format x '%g'; set xlabel 'DoLP of the irradiance'
set ylabel "residual"
set yrange [-0.01:0.01]; set ytics 0.01
plot 0.005 with lines linestyle 12, -0.005 with lines linestyle 12, \
     'sensor_reaching.csv' using 'DoLP':'residual' with points linetype 1
unset multiplot
