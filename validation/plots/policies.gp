# X.spectra: interpolation and extrapolation of three entries (policies.csv).
load style
set xrange [380:720]
set yrange [-0.05:1.4]
set xlabel 'wavelength [nm]'
set ylabel 'value'
set key top right maxrows 3
outside(x) = x < 450 || x > 650 ? 1 : NaN
$entries << EOD
nm,value
450,0.4
550,0.9
650,0.6
EOD
plot 'policies.csv' using 'nm':(column('hold') * outside(column('nm'))) with lines linetype 1 title 'hold', \
     'policies.csv' using 'nm':(column('zero') * outside(column('nm'))) with lines linetype 2 title 'zero', \
     'policies.csv' using 'nm':(column('linear') * outside(column('nm'))) with lines linetype 3 title 'linear', \
     'policies.csv' using 'nm':'forbid' with lines linetype 7 dashtype solid title 'between entries', \
     $entries using 1:2 with points linestyle 11 title 'entries'
