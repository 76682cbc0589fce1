# X.spectra: one black body per nanometre and per electronvolt, each by its maximum (densities.csv).
load style
set xrange [200:2500]
set yrange [0:1.1]
set xlabel 'wavelength [nm]'
set ylabel 'density / its maximum'
stats 'densities.csv' using 'per_nm' name 'nm' nooutput
stats 'densities.csv' using 'per_eV' name 'eV' nooutput
set key top right
plot 'densities.csv' using 'nm':(column('per_nm') / nm_max) with lines linetype 1 title 'per nm', \
     'densities.csv' using 'nm':(column('per_eV') / eV_max) with lines linetype 2 title 'per eV'
