# The thesis's diffuse term against the view zenith.
load style
of(p, v, c) = abs(column(p) - v) < 1e-6 ? column(c) : NaN
set xrange [0:90]; set xtics 15; set xlabel 'view zenith [deg]'
set ylabel '(1 - DHR) / π [sr^{-1}]'
set key top left Left reverse title 'σ' samplen 2
plot for [s in '0.05 0.1 0.2 0.3'] 'diffuse.csv' using 'view_deg':(of('sigma', s+0, 'diffuse_per_sr')) with lines title s
