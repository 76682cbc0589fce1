# X.DHR: errors of the DHR table (lines) and of a 500,000-point sum (points) (errors.csv).
# The zenith angle is drawn by the logarithm of the angle above the horizon.
width = 800
load style
set logscale y
set yrange [1e-9:2]
set format y '10^{%L}'
set ylabel 'absolute error of the DHR'
across(zenith) = -log10(90.1 - zenith)
set xrange [across(0):across(90)]
set xtics ('0°' across(0), '45°' across(45), '75°' across(75), '85°' across(85), '88°' across(88), '89°' across(89), '89.9°' across(89.9))
set xlabel 'zenith angle'
set key outside right top
only(s, x) = abs(column('sigma') - s) < 1e-6 ? x : NaN
shown(e) = e > 1e-9 ? e : 1e-9
set datafile missing NaN
plot 1e-5 linestyle 12 title 'aim of the table', \
     for [k=1:4] s = word('0.011 0.051 0.201 0.599', k) 'errors.csv' \
       using (only(s + 0, across(column('zenith_deg')))):(shown(column('table_error_abs'))) with lines linetype k title 'table, σ = '.s, \
     for [k=1:4] s = word('0.011 0.051 0.201 0.599', k) 'errors.csv' \
       using (only(s + 0, across(column('zenith_deg')))):(shown(column('sum_error_abs'))) with points linetype k title 'sum, σ = '.s
