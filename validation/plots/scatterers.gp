# X.sky: how air, Siewert's spheroids and Henyey and Greenstein's particles scatter sunlight (scatterers.csv).
width = 880; height = 370
load style
set xrange [0:180]; set xtics 45
set xlabel 'scattering angle [deg]'
set multiplot
set lmargin at screen 0.08; set rmargin at screen 0.47
set tmargin at screen 0.9; set bmargin at screen 0.22
set title 'how much: a_1' offset 0,-0.5
set logscale y; set yrange [0.05:20]; set ytics (0.1, 1, 10)
set key top right
plot 'scatterers.csv' using 'angle_deg':'air_a1' with lines title 'air', \
     '' using 'angle_deg':'spheroids_a1' with lines title 'spheroids', \
     '' using 'angle_deg':'forward_a1' with lines title 'g = 0.7'
set lmargin at screen 0.58; set rmargin at screen 0.97
set title 'how polarised: b_1 / a_1' offset 0,-0.5
unset logscale y; set yrange [-0.2:1]; set ytics -0.2,0.2,1
unset key
plot 'scatterers.csv' using 'angle_deg':(column('air_b1') / column('air_a1')) with lines, \
     '' using 'angle_deg':(column('spheroids_b1') / column('spheroids_a1')) with lines, \
     '' using 'angle_deg':(column('forward_b1') / column('forward_a1')) with lines
unset multiplot
