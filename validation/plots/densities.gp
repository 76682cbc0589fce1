# X.spectra: one black body per nanometre and per electronvolt, each by its maximum (densities.csv).
load style
set xrange [200:2500]
set yrange [0:1.1]
set xlabel 'wavelength [nm]'
set ylabel 'density / its maximum'
set key top right
plot 'densities.csv' using 'nm':'per_nm_by_its_maximum' with lines linetype 1 title 'per nm', \
     'densities.csv' using 'nm':'per_eV_by_its_maximum' with lines linetype 2 title 'per eV'
