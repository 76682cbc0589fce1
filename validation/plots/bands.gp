# X.spectra: light and band responses around 600 nm (bands.csv).
load style
set xrange [480:720]
set yrange [0:1.1]
set xlabel 'wavelength [nm]'
set ylabel 'light, response'
set key at graph 1,0.85
set arrow from 600,0 to 600,1 nohead linetype 7
plot 'bands.csv' using 'nm':'light' with lines linecolor rgb '#a0a0a0' linewidth 4 title 'light', \
     'bands.csv' using 'nm':'rectangular' with lines linetype 1 title 'rectangular', \
     'bands.csv' using 'nm':'gaussian' with lines linetype 2 title 'Gaussian', \
     'bands.csv' using 'nm':'tabulated' with lines linetype 3 title 'tabulated', \
     NaN with lines linetype 7 title 'narrow'
